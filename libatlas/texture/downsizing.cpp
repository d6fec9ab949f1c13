#include "libatlas/texture/downsizing.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace atlas {
namespace {

using Texel = SampledChart::Texel;

// The mean of the covered texels of the quad at (2x, 2y), and the largest deviation from it.
Texel quad_mean(const SampledChart& in, int x, int y, float& deviation) {
  const Texel* covered[4];
  int n = 0;
  for (int j = 2 * y; j < std::min(2 * y + 2, in.height); ++j)
    for (int i = 2 * x; i < std::min(2 * x + 2, in.width); ++i) {
      const Texel& t = in.texels[std::size_t(j) * in.width + i];
      if (t.weight > 0) covered[n++] = &t;
    }
  Texel mean;
  if (n == 0) return mean;
  mean.weight = 1;
  for (int k = 0; k < 3; ++k) {
    float sum = 0;
    for (int i = 0; i < n; ++i) sum += covered[i]->rgb[k];
    mean.rgb[k] = sum / static_cast<float>(n);
    for (int i = 0; i < n; ++i)
      deviation = std::max(deviation, std::fabs(covered[i]->rgb[k] - mean.rgb[k]));
  }
  return mean;
}

// False as soon as a quad moves too far.
bool halve(const SampledChart& in, float threshold, SampledChart& out) {
  out.width = (in.width + 1) / 2;
  out.height = (in.height + 1) / 2;
  out.texels.resize(std::size_t(out.width) * out.height);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      float deviation = 0;
      out.texels[std::size_t(y) * out.width + x] = quad_mean(in, x, y, deviation);
      if (!(deviation < threshold)) return false;
    }
  return true;
}

// Bilinear value of `in` at (x, y) in its texels, of covered texels only.
bool look_up(const SampledChart& in, float x, float y, float rgb[3]) {
  const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
  const float tx = x - 0.5f - fx, ty = y - 0.5f - fy;
  float total = 0;
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int u = std::clamp(static_cast<int>(fx) + i, 0, in.width - 1);
      const int v = std::clamp(static_cast<int>(fy) + j, 0, in.height - 1);
      const Texel& t = in.texels[std::size_t(v) * in.width + u];
      if (!(t.weight > 0)) continue;
      const float w = (i ? tx : 1 - tx) * (j ? ty : 1 - ty);
      for (int k = 0; k < 3; ++k) rgb[k] += w * t.rgb[k];
      total += w;
    }
  if (!(total > 0)) return false;
  for (int k = 0; k < 3; ++k) rgb[k] /= total;
  return true;
}

void measure(const SampledChart& full, const SampledChart& small, Downsizing& out) {
  const float scale = std::ldexp(1.0f, -out.halvings);
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x) {
      const Texel& t = full.texels[std::size_t(y) * full.width + x];
      if (!(t.weight > 0)) continue;
      ++out.covered;
      if (out.halvings == 0) continue;
      float rgb[3];
      const bool found = look_up(small, (static_cast<float>(x) + 0.5f) * scale,
                                 (static_cast<float>(y) + 0.5f) * scale, rgb);
      for (int k = 0; found && k < 3; ++k) {
        const float e = std::fabs(rgb[k] - t.rgb[k]);
        out.square_sum += double{e} * e;
        out.max_error = std::max(out.max_error, e);
      }
    }
}

}  // namespace

Downsizing downsize(SampledChart full, const TextureOptions& options) {
  Downsizing out;
  const auto threshold = static_cast<float>(options.threshold);
  SampledChart current, next;
  const SampledChart* last = &full;
  while (std::max(last->width, last->height) > 1 &&
         (std::min(last->width, last->height) + 1) / 2 >= options.min_side &&
         halve(*last, threshold, next)) {
    std::swap(current, next);
    last = &current;
    ++out.halvings;
  }
  out.width = last->width;
  out.height = last->height;
  measure(full, *last, out);
  return out;
}

}  // namespace atlas
