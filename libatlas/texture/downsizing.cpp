#include "libatlas/texture/downsizing.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "libatlas/core/lanes.h"

namespace atlas {
namespace {

// The most that a display value may change in all, relative to the threshold of one halving. A ramp
// that its quads allow to be halved stays below it, also in the corner, where there is nothing to
// interpolate with.
constexpr double kMostOfThreshold = 2;

using Texel = SampledChart::Texel;
static_assert(sizeof(Texel) == sizeof(Lanes));

// R, G, B and the weight.
Lanes load(const Texel& t) {
  Lanes v;
  std::memcpy(&v, &t, sizeof v);
  return v;
}

Lanes distance(Lanes a, Lanes b) {
  return larger_lanes(a - b, b - a);
}

float largest_channel(Lanes v) {
  return std::max({v[0], v[1], v[2]});
}

// Returns the mean of the covered texels of the quad at (2x, 2y), and raises `deviation` to the
// largest deviation from the mean.
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

// Halves quads of row y from the left, up to the first quad that is not completely covered. Most
// quads are, and for these the sums of all channels are computed at once. Returns the number of
// halved quads.
int halve_covered(const SampledChart& in, int y, Texel* out, Lanes& deviation) {
  if (2 * y + 1 >= in.height) return 0;
  const Texel* lower = &in.texels[std::size_t(2 * y) * in.width];
  const Texel* upper = lower + in.width;
  int x = 0;
  for (; 2 * x + 1 < in.width; ++x, lower += 2, upper += 2) {
    if (!(lower[0].weight > 0 && lower[1].weight > 0 && upper[0].weight > 0 && upper[1].weight > 0))
      break;
    const Lanes a = load(lower[0]), b = load(lower[1]), c = load(upper[0]), d = load(upper[1]);
    Lanes mean = (a + b + c + d) * 0.25f;
    deviation =
        larger_lanes(deviation, larger_lanes(larger_lanes(distance(a, mean), distance(b, mean)),
                                             larger_lanes(distance(c, mean), distance(d, mean))));
    mean[3] = 1;
    std::memcpy(static_cast<void*>(&out[x]), &mean, sizeof mean);
  }
  return x;
}

// Halves the texture. Returns false as soon as a row contains a quad that changes by the threshold
// or more.
bool halve(const SampledChart& in, float threshold, SampledChart& out) {
  out.width = (in.width + 1) / 2;
  out.height = (in.height + 1) / 2;
  out.texels.resize(std::size_t(out.width) * out.height);
  for (int y = 0; y < out.height; ++y) {
    Texel* row = &out.texels[std::size_t(y) * out.width];
    Lanes most{};
    for (int x = halve_covered(in, y, row, most); x < out.width; ++x) {
      float deviation = 0;
      row[x] = quad_mean(in, x, y, deviation);
      if (!(deviation < threshold)) return false;
    }
    if (!(largest_channel(most) < threshold)) return false;
  }
  return true;
}

// The two texels of a row or column of the halved texture that a full texel's centre lies between.
struct Between {
  int low = 0, high = 0;
  float share = 0;  // weight of `high` in the interpolation
};

std::vector<Between> places(int full, int small, int halvings) {
  const float scale = std::ldexp(1.0f, -halvings);
  std::vector<Between> out(static_cast<std::size_t>(full));
  for (int i = 0; i < full; ++i) {
    const float at = (static_cast<float>(i) + 0.5f) * scale - 0.5f, floor = std::floor(at);
    const int low = static_cast<int>(floor);
    out[static_cast<std::size_t>(i)] = {std::clamp(low, 0, small - 1),
                                        std::clamp(low + 1, 0, small - 1), at - floor};
  }
  return out;
}

// Interpolates one row between two rows of halved texels. A halved texel has weight 1 if it is
// covered, and is 0 in all lanes otherwise. An interpolated sum therefore holds the sum of the
// covered texels' interpolation weights in the 4th lane, and the mean colour of these texels times
// that sum in R, G, B.
void blend_rows(const SampledChart& in, const Between& row, std::vector<Lanes>& out) {
  const Texel* low = &in.texels[std::size_t(row.low) * in.width];
  const Texel* high = &in.texels[std::size_t(row.high) * in.width];
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = (1 - row.share) * load(low[i]) + row.share * load(high[i]);
}

// Measures the errors of `full` against the bilinear values of `small`'s covered texels. Returns
// false, at the first such row, if an error exceeds the limit. The full texture itself has none.
bool measure(const SampledChart& full, const SampledChart& small, float limit, Downsizing& out) {
  out.square_sum = 0;
  out.max_error = 0;
  out.covered = 0;
  const std::vector<Between> columns = places(full.width, small.width, out.halvings);
  const std::vector<Between> rows = places(full.height, small.height, out.halvings);
  std::vector<Lanes> line(static_cast<std::size_t>(small.width));
  Lanes most{};
  for (int y = 0; y < full.height; ++y) {
    if (out.halvings > 0) blend_rows(small, rows[std::size_t(y)], line);
    const Texel* texels = &full.texels[std::size_t(y) * full.width];
    Lanes square{};
    for (int x = 0; x < full.width; ++x) {
      if (!(texels[x].weight > 0)) continue;
      ++out.covered;
      if (out.halvings == 0) continue;
      const Between& at = columns[std::size_t(x)];
      const Lanes sum =
          (1 - at.share) * line[std::size_t(at.low)] + at.share * line[std::size_t(at.high)];
      if (!(sum[3] > 0)) continue;
      const Lanes error = distance(sum * (1 / sum[3]), load(texels[x]));
      square += error * error;
      most = larger_lanes(most, error);
    }
    for (int k = 0; k < 3; ++k) out.square_sum += double{square[k]};
    out.max_error = largest_channel(most);
    if (out.halvings > 0 && !(out.max_error <= limit)) return false;
  }
  return true;
}

// Halves the texture at most `most` times, as long as the quads allow it. Returns how often; the
// last texture lies where halved() says.
int halve_up_to(int most, const SampledChart& full, const TextureOptions& options,
                HalvedCharts& room) {
  const auto threshold = static_cast<float>(options.threshold);
  const SampledChart* last = &full;
  int halvings = 0;
  while (halvings < most && std::max(last->width, last->height) > 1 &&
         (std::min(last->width, last->height) + 1) / 2 >= options.min_side &&
         halve(*last, threshold, room[halvings % 2])) {
    last = &room[halvings % 2];
    ++halvings;
  }
  return halvings;
}

const SampledChart& halved(int times, const SampledChart& full, const HalvedCharts& room) {
  return times == 0 ? full : room[(times - 1) % 2];
}

}  // namespace

Downsizing downsize(const SampledChart& full, const TextureOptions& options, HalvedCharts& room) {
  Downsizing out;
  const auto limit = static_cast<float>(kMostOfThreshold * options.threshold);
  out.halvings = halve_up_to(std::numeric_limits<int>::max(), full, options, room);
  while (!measure(full, halved(out.halvings, full, room), limit, out))
    out.halvings = halve_up_to(out.halvings - 1, full, options, room);
  const SampledChart& last = halved(out.halvings, full, room);
  out.width = last.width;
  out.height = last.height;
  return out;
}

}  // namespace atlas
