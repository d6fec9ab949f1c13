// Computes area-weighted luminance statistics for automatic exposure.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/core/is_finite.h"
#include "libatlas/core/luma.h"
#include "libatlas/core/percentile.h"
#include "libatlas/scene/triangle_area.h"
#include "libatlas/texture/tone.h"
#include "libatlas/texture/visibility.h"

namespace atlas {
namespace {

// The number of samples. It gives a 99th percentile whose rank is accurate to about one part in a
// hundred.
constexpr std::size_t kSamples = 1 << 18;

// Fewer seen samples than this are not enough for a 99th percentile.
constexpr std::size_t kSeenNeeded = 4096;

// Computes point i of the plastic-number sequence (Roberts 2018), folded into barycentric
// coordinates.
void barycentric(std::uint64_t i, float b[3]) {
  double u = 0.5 + 0.7548776662466927 * static_cast<double>(i);
  double v = 0.5 + 0.5698402909980532 * static_cast<double>(i);
  u -= std::floor(u);
  v -= std::floor(v);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  b[0] = static_cast<float>(1 - u - v);
  b[1] = static_cast<float>(u);
  b[2] = static_cast<float>(v);
}

Vec3f point(const Scene& s, std::size_t t, const float b[3]) {
  Vec3f p;
  for (int k = 0; k < 3; ++k) {
    const Vec3f q = s.positions[s.indices[3 * t + k]];
    p = {p.x + b[k] * q.x, p.y + b[k] * q.y, p.z + b[k] * q.z};
  }
  return p;
}

// What logarithms are taken of at least, since the luma of denormal light may be 0.
constexpr float kLeastLuma = 1e-37f;

// Surfaces whose luminance is at least this share of the 90th percentile count as lit in a view:
// lamps and sunlight rarely cover a tenth of it, and film holds a range of about a hundred, too.
constexpr double kBrightQuantile = 0.9;
constexpr float kLitShare = 0.01f;

std::vector<float> picked(const std::vector<float>& values,
                          const std::vector<std::uint32_t>& samples) {
  std::vector<float> out;
  out.reserve(samples.size());
  for (const std::uint32_t i : samples) out.push_back(values[i]);
  return out;
}

// Returns the median of the luma that counts as lit.
double middle_of(std::vector<float> lumas) {
  const float least = kLitShare * percentile(lumas, kBrightQuantile);
  std::erase_if(lumas, [least](float y) { return y < least; });
  return percentile(lumas, 0.5);
}

struct Collector {
  LuminanceStatistics out;
  std::vector<Vec3f> points;        // of the samples of finite luminance
  std::vector<float> peaks, lumas;  // their largest channel and luma
  std::vector<std::uint32_t> lit;   // those whose largest channel is above 0
  double sum = 0, rgb[3] = {0, 0, 0}, log_sum = 0;

  void add(const Vec3f& position, const Vec3f& c) {
    if (!is_finite(c)) {
      ++out.not_finite;
      return;
    }
    out.negative += c.x < 0 || c.y < 0 || c.z < 0;
    const float v[3] = {std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f)};
    const float top = std::max({v[0], v[1], v[2]});
    const float y = luma(v[0], v[1], v[2]);
    if (top > 0) lit.push_back(static_cast<std::uint32_t>(points.size()));
    points.push_back(position);
    peaks.push_back(top);
    lumas.push_back(std::max(y, kLeastLuma));
    if (top <= 0) return;
    sum += y;
    for (int k = 0; k < 3; ++k) rgb[k] += v[k];
    log_sum += std::log(lumas.back());
  }

  // Sets what depends on what is visible.
  void view(double area_per_sample) {
    std::vector<std::uint32_t> seen =
        seen_samples(points, area_per_sample * static_cast<double>(points.size()), kSeenNeeded);
    std::erase_if(seen, [this](std::uint32_t i) { return peaks[i] <= 0; });
    out.seen = seen.size() >= kSeenNeeded;
    const std::vector<std::uint32_t>& samples = out.seen ? seen : lit;
    std::vector<float> top = picked(peaks, samples), y = picked(lumas, samples);
    out.percentile98 = percentile(top, 0.98);
    out.percentile99 = percentile(top, 0.99);
    out.median = percentile(y, 0.5);
    out.middle = middle_of(std::move(y));
  }

  void finish(double area_per_sample) {
    const auto count = static_cast<double>(lit.size());
    out.lit_area = area_per_sample * count;
    out.unlit_area = area_per_sample * static_cast<double>(points.size() - lit.size());
    if (lit.empty()) return;
    out.maximum = *std::max_element(peaks.begin(), peaks.end());
    view(area_per_sample);
    std::vector<float> y = picked(lumas, lit);
    out.minimum_log = std::log(double(percentile(y, 0.01)));
    out.maximum_log = std::log(double(percentile(y, 0.99)));
    out.mean = sum / count;
    out.log_average = std::exp(log_sum / count);
    out.mean_rgb = {static_cast<float>(rgb[0] / count), static_cast<float>(rgb[1] / count),
                    static_cast<float>(rgb[2] / count)};
  }
};

}  // namespace

Result<LuminanceStatistics> measure_luminance(const LuminanceSampler& sampler,
                                              const Context& context) {
  const Scene& scene = sampler.scene();
  const std::size_t n = scene.triangle_count();
  double total = 0;
  for (std::size_t t = 0; t < n; ++t) {
    if ((t & 0xffff) == 0 && context.cancelled()) return Status::cancelled();
    total += triangle_area(scene, t);
  }
  if (!(total > 0) || !std::isfinite(total))
    return Status{ErrorCode::bad_input, "the scene has no triangle with area, so no luminance"};

  // The area of the triangles, added up in their order, is divided into kSamples equal shares. One
  // sample is taken for the middle of each share.
  const double share = total / kSamples;
  Collector collector;
  double area = 0;
  std::size_t i = 0;
  for (std::size_t t = 0; t < n && i < kSamples; ++t) {
    if ((t & 0xffff) == 0 && context.cancelled()) return Status::cancelled();
    area += triangle_area(scene, t);
    if ((static_cast<double>(i) + 0.5) * share >= area) continue;
    const auto triangle = sampler.prepare(static_cast<std::uint32_t>(t), 0);
    for (; i < kSamples && (static_cast<double>(i) + 0.5) * share < area; ++i) {
      float b[3];
      barycentric(i, b);
      collector.add(point(scene, t, b), LuminanceSampler::sample(triangle, b[0], b[1], b[2]));
    }
  }
  collector.finish(share);
  return collector.out;
}

}  // namespace atlas
