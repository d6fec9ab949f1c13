#include "libatlas/bake/fidelity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "libatlas/core/is_finite.h"
#include "libatlas/core/luma.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/percentile.h"
#include "libatlas/core/random.h"
#include "libatlas/core/srgb.h"
#include "libatlas/scene/triangle_area.h"

namespace atlas {
namespace {

struct Sample {
  std::int32_t page = -1;
  Vec2f texel;      // position on the page
  Vec3f luminance;  // the input's
  Vec3f shown;      // display values found in the atlas
  bool found = false;
};

// In the image's own values.
template <class T>
Vec3f bilinear(const Image<T>& image, Vec2f at) {
  const float fx = std::floor(at.x - 0.5f), fy = std::floor(at.y - 0.5f);
  const float tx = at.x - 0.5f - fx, ty = at.y - 0.5f - fy;
  const auto column = [&](float x) { return std::clamp(static_cast<int>(x), 0, image.width - 1); };
  const auto row = [&](float y) { return std::clamp(static_cast<int>(y), 0, image.height - 1); };
  const T* p[4] = {image.at(column(fx), row(fy)), image.at(column(fx + 1), row(fy)),
                   image.at(column(fx), row(fy + 1)), image.at(column(fx + 1), row(fy + 1))};
  float out[3];
  for (int k = 0; k < 3; ++k) {
    const float low = (1 - tx) * p[0][k] + tx * p[1][k], high = (1 - tx) * p[2][k] + tx * p[3][k];
    out[k] = (1 - ty) * low + ty * high;
  }
  return {out[0], out[1], out[2]};
}

double luma_of(const float c[3]) {
  return luma<double>(c[0], c[1], c[2]);
}

// Pages cannot show negative light, and the statistics count it as 0 as well.
float positive(float v) {
  return v > 0 ? v : 0.0f;
}

double decibels(double mean_square) {
  return mean_square > 0 ? -10 * std::log10(mean_square) : kPerfectDecibels;
}

// The sums of errors over samples, which are added in the order in which they were drawn.
struct Sums {
  const ToneMapping& tone;
  Fidelity out;
  double square[3] = {0, 0, 0}, square_all = 0, scene_square = 0;
  std::uint64_t all = 0, scene_count = 0;
  std::vector<float> worst;
  std::vector<WorstPlace> places;  // one per lit sample

  void add(const Sample& s) {
    if (!s.found) {
      ++out.unplaced;
      return;
    }
    const Vec3f light{positive(s.luminance.x), positive(s.luminance.y), positive(s.luminance.z)};
    const Vec3f want = tone.display(light);
    const float w[3] = {want.x, want.y, want.z}, g[3] = {s.shown.x, s.shown.y, s.shown.z};
    const float c[3] = {light.x, light.y, light.z};
    const bool lit = c[0] > 0 || c[1] > 0 || c[2] > 0;
    float largest = 0;
    ++all;
    for (int k = 0; k < 3; ++k) {
      const double d = double{g[k]} - w[k];
      largest = std::max(largest, static_cast<float>(std::fabs(d)));
      square_all += d * d;
      if (lit) square[k] += d * d;
    }
    ++(lit ? out.lit : out.unlit);
    if (!lit) return;
    worst.push_back(largest);
    places.push_back({s.page, s.texel, want, s.shown, largest});
    if (std::max({w[0], w[1], w[2]}) >= 1) {
      ++out.clipped;
    } else if (tone.op == ToneOperator::linear) {
      float back[3];
      for (int k = 0; k < 3; ++k) back[k] = srgb_decode(g[k]) / tone.scale;
      const double d = luma_of(back) - luma_of(c);
      scene_square += d * d;
      ++scene_count;
    }
  }

  Fidelity finish() {
    if (all > 0) out.psnr_all = decibels(square_all / (3.0 * static_cast<double>(all)));
    if (scene_count > 0) out.rmse = std::sqrt(scene_square / static_cast<double>(scene_count));
    if (out.lit == 0) return out;
    const auto n = static_cast<double>(out.lit);
    for (int k = 0; k < 3; ++k) out.psnr_channel[k] = decibels(square[k] / n);
    const double mean = (square[0] + square[1] + square[2]) / (3 * n);
    out.psnr = decibels(mean);
    out.rmse_display = std::sqrt(mean);
    out.p95 = percentile(worst, 0.95);
    out.p999 = percentile(worst, 0.999);
    out.maximum = *std::max_element(worst.begin(), worst.end());
    choose_worst();
    return out;
  }

  void choose_worst() {
    std::stable_sort(places.begin(), places.end(),
                     [](const WorstPlace& a, const WorstPlace& b) { return a.error > b.error; });
    for (const WorstPlace& place : places) {
      if (out.worst.size() == kWorstPlaces || !(place.error > 0)) break;
      const bool apart =
          std::none_of(out.worst.begin(), out.worst.end(), [&](const WorstPlace& other) {
            return other.page == place.page &&
                   std::hypot(other.texel.x - place.texel.x, other.texel.y - place.texel.y) <
                       kWorstDistance;
          });
      if (apart) out.worst.push_back(place);
    }
  }
};

// The place of a sample on the surface, before its light is known.
struct Point {
  std::uint32_t triangle = 0;
  double weight[3] = {0, 0, 0};  // barycentric coordinates
};

// Draws stratified points: one at a random place in each equal share of the running area. Returns
// none if the surface has no area.
std::vector<Point> draw_points(const Scene& scene, const FidelityOptions& options,
                               const Context& context) {
  std::vector<Point> points;
  double total = 0;
  for (std::size_t t = 0; t < scene.triangle_count(); ++t) total += triangle_area(scene, t);
  if (!(total > 0)) return points;
  const double share = total / options.samples;
  std::mt19937_64 random(options.seed);
  double area = 0, next = share * uniform(random);
  points.reserve(options.samples);
  for (std::size_t t = 0; t < scene.triangle_count() && !context.cancelled(); ++t) {
    area += triangle_area(scene, t);
    while (next < area && points.size() < options.samples) {
      const double r = std::sqrt(uniform(random)), v = uniform(random);
      points.push_back({static_cast<std::uint32_t>(t), {1 - r, r * (1 - v), r * v}});
      next = share * (static_cast<double>(points.size()) + uniform(random));
    }
  }
  return points;
}

// Determines the light of points, and where they lie on the pages.
struct SampleMaker {
  const ChartLight& light;
  std::span<const ChartPlacement> placements;
  const std::vector<std::int64_t>& placed;  // one per chart: the index of its placement, or -1

  void make(std::span<const Point> points, std::span<Sample> samples) const {
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end) {
      const std::uint32_t t = points[begin].triangle;
      const auto lit = light.sampler.prepare(t, 0);
      for (end = begin; end < points.size() && points[end].triangle == t; ++end) {
        const double* b = points[end].weight;
        samples[end].luminance = LuminanceSampler::sample(
            lit, static_cast<float>(b[0]), static_cast<float>(b[1]), static_cast<float>(b[2]));
        place(points[end], samples[end]);
      }
    }
  }

  void place(const Point& point, Sample& sample) const {
    const std::int64_t at = placed[light.charts.triangle_chart[point.triangle]];
    if (at < 0) return;
    Vec2d uv;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t corner = 3 * std::size_t{point.triangle} + k;
      const Vec2d q = light.charts.uvs[light.charts.triangle_uv[corner]];
      uv = {uv.x + point.weight[k] * q.x, uv.y + point.weight[k] * q.y};
    }
    const ChartPlacement& placement = placements[std::size_t(at)];
    const Vec2d texel = page_texel(placement, uv);
    sample.texel = {static_cast<float>(texel.x), static_cast<float>(texel.y)};
    sample.page = placement.page;
  }
};

// Whether every triangle has a chart and uvs. Samples lie on all triangles, whatever was placed.
Status check_triangles(const ChartSet& charts) {
  const auto beyond = [](const std::vector<std::uint32_t>& ids, std::size_t end) {
    return !ids.empty() && *std::max_element(ids.begin(), ids.end()) >= end;
  };
  if (!beyond(charts.triangle_chart, charts.charts.size()) &&
      !beyond(charts.triangle_uv, charts.uvs.size()))
    return {};
  return {ErrorCode::bad_input,
          fmt::format("triangle_chart or triangle_uv reaches beyond the {} charts or {} uvs",
                      charts.charts.size(), charts.uvs.size())};
}

}  // namespace

struct FidelityMeter::State {
  ToneMapping tone;
  std::vector<Sample> samples;         // in the order drawn
  std::vector<std::uint32_t> by_page;  // sample ids sorted by page

  std::span<const std::uint32_t> on_page(std::int32_t page) const {
    const auto before = [this](std::uint32_t id, std::int32_t p) { return samples[id].page < p; };
    const auto begin = std::lower_bound(by_page.begin(), by_page.end(), page, before);
    return {begin, std::lower_bound(begin, by_page.end(), page + 1, before)};
  }
};

FidelityMeter::FidelityMeter(std::unique_ptr<State> state) : state_(std::move(state)) {}
FidelityMeter::FidelityMeter(FidelityMeter&&) noexcept = default;
FidelityMeter& FidelityMeter::operator=(FidelityMeter&&) noexcept = default;

Result<FidelityMeter> FidelityMeter::make(const ChartLight& light,
                                          std::span<const ChartPlacement> placements,
                                          const FidelityOptions& options, const Context& context) {
  if (Status s = check_scene_of(light); !s.ok()) return s;
  if (Status s = check_triangles(light.charts); !s.ok()) return s;
  std::vector<std::int64_t> placed(light.charts.charts.size(), -1);
  for (std::size_t i = 0; i < placements.size(); ++i) {
    if (placements[i].chart >= placed.size())
      return Status(ErrorCode::bad_input,
                    fmt::format("placement {} names chart {}, but there are {}", i,
                                placements[i].chart, placed.size()));
    const ChartPlacement& p = placements[i];
    if (!is_finite(p.texels_per_unit) || !is_finite(p.offset) || !std::isfinite(p.cosine) ||
        !std::isfinite(p.sine))
      return Status(ErrorCode::bad_input, fmt::format("placement {} is not finite", i));
    placed[p.chart] = static_cast<std::int64_t>(i);
  }
  const std::vector<Point> points = draw_points(light.sampler.scene(), options, context);
  auto state = std::make_unique<State>(State{light.tone, std::vector<Sample>(points.size()),
                                             std::vector<std::uint32_t>(points.size())});
  const SampleMaker maker{light, placements, placed};
  // Blocks of this many points are long enough that the light of a large triangle is prepared once
  // for many of its samples.
  constexpr std::size_t kGrain = 1024;
  parallel_for(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    maker.make(std::span(points).subspan(begin, end - begin),
               std::span(state->samples).subspan(begin, end - begin));
  });
  if (context.cancelled()) return Status::cancelled();
  std::iota(state->by_page.begin(), state->by_page.end(), 0u);
  std::stable_sort(state->by_page.begin(), state->by_page.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return state->samples[a].page < state->samples[b].page;
                   });
  return FidelityMeter(std::move(state));
}

FidelityMeter::~FidelityMeter() = default;

void FidelityMeter::add_page(std::int32_t page, const Image8& display) {
  if (display.empty() || display.channels < 3 || !display.whole()) return;
  for (const std::uint32_t id : state_->on_page(page)) {
    Sample& sample = state_->samples[id];
    const Vec3f v = bilinear(display, sample.texel);
    sample.shown = {v.x * (1.0f / 255), v.y * (1.0f / 255), v.z * (1.0f / 255)};
    sample.found = true;
  }
}

void FidelityMeter::add_light_page(std::int32_t page, const ImageF& light) {
  if (light.empty() || light.channels < 3 || !light.whole()) return;
  for (const std::uint32_t id : state_->on_page(page)) {
    Sample& sample = state_->samples[id];
    sample.shown = state_->tone.display(bilinear(light, sample.texel));
    sample.found = true;
  }
}

FidelityMeter::Cells FidelityMeter::cells(std::int32_t page, int width, int height,
                                          int side) const {
  const auto count = [&](int texels) { return std::size_t((texels + side - 1) / side); };
  const std::size_t columns = count(width), rows = count(height);
  std::vector<double> square(columns * rows, 0);
  std::vector<std::uint32_t> samples(square.size(), 0);
  for (const std::uint32_t id : state_->on_page(page)) {
    const Sample& s = state_->samples[id];
    const auto place = [&](float texel, std::size_t most) {
      return std::min(most - 1, std::size_t(std::max(texel, 0.0f)) / std::size_t(side));
    };
    const std::size_t cell = place(s.texel.y, rows) * columns + place(s.texel.x, columns);
    const Vec3f want = state_->tone.display(
        {positive(s.luminance.x), positive(s.luminance.y), positive(s.luminance.z)});
    const double d[3] = {double{s.shown.x} - want.x, double{s.shown.y} - want.y,
                         double{s.shown.z} - want.z};
    square[cell] += (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / 3;
    ++samples[cell];
  }
  Cells result{columns, std::vector<float>(square.size(), -1)};
  for (std::size_t i = 0; i < square.size(); ++i)
    if (samples[i] > 0) result.rms[i] = static_cast<float>(std::sqrt(square[i] / samples[i]));
  return result;
}

Fidelity FidelityMeter::result() const {
  Sums sums{state_->tone, {}, {}, 0, 0, 0, 0, {}, {}};
  for (const Sample& s : state_->samples) sums.add(s);
  return sums.finish();
}

}  // namespace atlas
