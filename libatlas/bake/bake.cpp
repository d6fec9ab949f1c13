#include "libatlas/bake/bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/bake/chart_box.h"
#include "libatlas/bake/page_owners.h"
#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/parallel.h"
#include "libatlas/raster/coverage.h"
#include "libatlas/raster/splat_triangle.h"
#include "libatlas/texture/triangle_light.h"

namespace atlas {
namespace {

// What baking a chart needs. If `tone` is null, texels get scene-linear values.
struct Job {
  const ChartLight& light;
  const BakeOptions& options;
  const SampleGrid& grid;
  const ToneMapping* tone;
  float low, high;  // bounds of the texels' values
};

// Light is never negative, so texels beside an edge are kept from falling below 0. If any value is
// negative, the signal is not light and has no bounds.
Job linear_job(const Job& display) {
  constexpr float kMost = std::numeric_limits<float>::max();
  const std::vector<Vec3f>& given = display.light.sampler.scene().illumination;
  const bool negative = std::any_of(given.begin(), given.end(),
                                    [](const Vec3f& v) { return v.x < 0 || v.y < 0 || v.z < 0; });
  return {display.light, display.options, display.grid, nullptr, negative ? -kMost : 0, kMost};
}

// Returns the distance between samples on the surface in scene units, which determines the mip
// level that is read from textures.
double sample_spacing(const ChartPlacement& p, int side) {
  return 1 / (std::sqrt(p.texels_per_unit.x * p.texels_per_unit.y) * side);
}

TexelGrid bake_least_squares(const Job& job, const ChartBox& box) {
  LeastSquares fit(box.width, box.height);
  const std::vector<GridSplat> splats = grid_splats(job.grid);
  const double spacing = sample_spacing(box.placement, job.grid.side);
  for (const std::uint32_t t : triangles_of(job.light.charts, box.chart(job.light.charts))) {
    const TexelTriangle p = box.triangle(job.light.charts, t);
    const SampleKind kind = sample_kind(p, job.grid);
    if (kind == SampleKind::none) continue;
    TriangleLight lit(job.light.sampler.prepare(t, spacing), job.tone);
    if (kind == SampleKind::grid) lit.set_position(p);
    splat_triangle(p, lit, {job.grid, splats, fit});
  }
  return std::move(fit).solve(job.low, job.high);
}

// The published method. Its shifts move the grid by up to half a texel around the centre of the
// texel.
TexelGrid bake_average(const Job& job, const ChartBox& box) {
  TexelGrid out(box.width, box.height);
  const double spacing = sample_spacing(box.placement, 1);
  const Rect clip{0, 0, box.width, box.height};
  for (const std::uint32_t t : triangles_of(job.light.charts, box.chart(job.light.charts))) {
    const TexelTriangle p = box.triangle(job.light.charts, t);
    if (sample_kind(p, job.grid) == SampleKind::none) continue;
    TriangleLight lit(job.light.sampler.prepare(t, spacing), job.tone);
    lit.set_position(p);
    for (int k = 0; k < job.grid.count; ++k) {
      const Vec2d shift{job.grid.offset[k].x - 0.5, job.grid.offset[k].y - 0.5};
      TexelTriangle q = p;
      for (Vec2d& corner : q) corner = {corner.x - shift.x, corner.y - shift.y};
      cover_triangle(q, clip, [&](int x, int y, double area, Vec2d c) {
        out.rgb[std::size_t(y) * out.width + x] +=
            static_cast<float>(area) * lit.inside({c.x + shift.x, c.y + shift.y});
      });
    }
  }
  for (std::size_t i = 0; i < out.rgb.size(); ++i) {
    const float weight = out.rgb[i][3];
    if (!(weight > 0)) continue;
    out.rgb[i] /= weight;
    out.known[i] = 1;
  }
  return out;
}

// If a chart is so small that no texel has got a value, the texel in the middle of its box takes
// the mean of the light at the centroids of its triangles. Black would be visible where coarse mip
// levels mix it with its neighbours.
void fill_tiny(const Job& job, const ChartBox& box, TexelGrid& texels) {
  if (std::find(texels.known.begin(), texels.known.end(), 1) != texels.known.end()) return;
  Lanes sum{};
  for (const std::uint32_t t : triangles_of(job.light.charts, box.chart(job.light.charts))) {
    const float middle[3] = {1.0f / 3, 1.0f / 3, 1.0f / 3};
    const double spacing = sample_spacing(box.placement, 1);
    sum += TriangleLight(job.light.sampler.prepare(t, spacing), job.tone).at(middle);
  }
  if (!(sum[3] > 0)) return;
  const std::size_t at = std::size_t(box.height / 2) * box.width + std::size_t(box.width / 2);
  texels.rgb[at] = sum / sum[3];
  texels.known[at] = 1;
}

TexelGrid bake_box(const Job& job, const ChartBox& box) {
  TexelGrid texels = job.options.method == BakeMethod::average ? bake_average(job, box)
                                                               : bake_least_squares(job, box);
  fill_tiny(job, box, texels);
  return texels;
}

// The texels of a box that its chart writes.
struct OwnTexels {
  const ChartBox& box;
  const std::vector<TexelRun>& runs;
};

// Copies the chart's own texels to the page. convert(colour) returns the three values to store, in
// its first three lanes.
template <class T, class Convert>
void copy_own(const TexelGrid& in, const OwnTexels& own, Image<T>& page, const Convert& convert) {
  for (const TexelRun& run : own.runs) {
    const std::size_t row = std::size_t(run.y - own.box.bottom()) * std::size_t(in.width),
                      first = row + std::size_t(run.x - own.box.left());
    T* to = page.at(run.x, run.y);
    for (const Lanes *v = &in.rgb[first], *end = v + run.length; v < end; ++v, to += 3) {
      const auto values = convert(*v);
      for (int k = 0; k < 3; ++k) to[k] = static_cast<T>(values[k]);
    }
  }
}

constexpr int kLargest = 1 << 16;

// How far a corner of a chart may lie from the lower left corner of its box along either axis, in
// texels. This is more than the diagonal of the largest page, and less than the largest coordinate
// that the rasteriser accepts.
constexpr double kReach = 1.5 * kLargest;
static_assert(kReach > 1.4143 * kLargest && kReach < kMaxTexelCoordinate - kLargest / 4);

bool reachable(const ChartPlacement& p, Vec2d size) {
  for (const Vec2d uv : {Vec2d{0, 0}, Vec2d{size.x, 0}, Vec2d{0, size.y}, size}) {
    const Vec2d q = page_texel(p, uv);
    if (!(std::fabs(q.x - p.x) <= kReach && std::fabs(q.y - p.y) <= kReach)) return false;
  }
  return true;
}

// Whether a placement lies on a page that can exist, with a turn of a rotation.
Status check_turn(const ChartPlacement& p) {
  constexpr double kRounding = 1e-5;  // of cosines and sines; a hundredth of a texel on a page
  if (p.page < 0)
    return {ErrorCode::bad_input,
            fmt::format("chart {}: its page is {} (at least 0)", p.chart, p.page)};
  if (!(std::fabs(std::hypot(p.cosine, p.sine) - 1) <= kRounding))
    return {ErrorCode::bad_input,
            fmt::format("chart {}: cosine {} and sine {} of its turn are not those of an angle",
                        p.chart, p.cosine, p.sine)};
  return {};
}

Status check(const ChartLight& light, std::span<const ChartPlacement> placements,
             const BakeOptions& o) {
  if (o.page_width < 1 || o.page_width > kLargest || o.page_height < 1 || o.page_height > kLargest)
    return {ErrorCode::bad_option, fmt::format("page of {} x {} texels; each side must be 1..{}",
                                               o.page_width, o.page_height, kLargest)};
  if (o.shifts < 1 || o.shifts > 64)
    return {ErrorCode::bad_option, fmt::format("{} shifts; there must be 1..64", o.shifts)};
  if (o.mip_levels < 0 || o.mip_levels > 10)
    return {ErrorCode::bad_option, fmt::format("{} mip levels; there must be 0..10", o.mip_levels)};
  if (!is_enumerator(o.method, BakeMethod::average))
    return {ErrorCode::bad_option, fmt::format("method {} (give a BakeMethod)", int(o.method))};
  if (Status s = check_scene_of(light); !s.ok()) return s;
  const int pad = gutter_pad(o.mip_levels);
  for (const ChartPlacement& p : placements) {
    if (p.page != placements[0].page)
      return {ErrorCode::bad_input,
              fmt::format("chart {} lies on page {}, and chart {} on page {} (bake each page with "
                          "its own placements)",
                          placements[0].chart, placements[0].page, p.chart, p.page)};
    if (p.chart >= light.charts.charts.size())
      return {ErrorCode::bad_input, fmt::format("a placement names chart {}, but there are {}",
                                                p.chart, light.charts.charts.size())};
    if (p.width < 1 || p.height < 1 || p.x < pad || p.y < pad ||
        p.x + std::int64_t{p.width} + pad > o.page_width ||
        p.y + std::int64_t{p.height} + pad > o.page_height)
      return {ErrorCode::bad_input,
              fmt::format("chart {}: its box {} x {} at ({}, {}) with {} texels of gutter leaves "
                          "the page of {} x {}",
                          p.chart, p.width, p.height, p.x, p.y, pad, o.page_width, o.page_height)};
    if (Status s = check_turn(p); !s.ok()) return s;
    if (!(p.texels_per_unit.x > 0) || !(p.texels_per_unit.y > 0))
      return {ErrorCode::bad_input,
              fmt::format("chart {}: its texel density is not above 0", p.chart)};
    if (!reachable(p, light.charts.charts[p.chart].size))
      return {ErrorCode::bad_input,
              fmt::format("chart {}: its density of {} x {} texels a unit, turn and offset put it "
                          "more than {} texels off its box",
                          p.chart, p.texels_per_unit.x, p.texels_per_unit.y, kReach)};
    if (Status s = check_light(light, p.chart); !s.ok()) return s;
  }
  return {};
}

// Returns the warning for a page that was packed for fewer mip levels than are baked.
std::string contested_text(const PageOwners& owners, int mip_levels) {
  return fmt::format(
      "{} texels belong to several charts, the first at ({}, {}) to {} and {}: look-ups at the "
      "coarser of mip levels 0 to {} mix their light (pack with a padding of {} and an alignment "
      "of "
      "{} texels, or bake fewer mip levels)",
      owners.contested, owners.x, owners.y, owners.charts[0], owners.charts[1], mip_levels,
      gutter_pad(mip_levels), 1 << mip_levels);
}

}  // namespace

Result<BakedPage> bake_page(const ChartLight& light, std::span<const ChartPlacement> placements,
                            const BakeOptions& options, const Context& context) {
  if (Status s = check(light, placements, options); !s.ok()) return s;
  BakedPage page;
  page.display = Image8(options.page_width, options.page_height, 3);
  if (options.linear) page.linear = ImageF(options.page_width, options.page_height, 3);
  const SampleGrid grid(options.shifts);
  const Job display{light, options, grid, &light.tone, 0, 1};
  const std::optional<Job> linear =
      options.linear ? std::optional(linear_job(display)) : std::nullopt;
  const PageOwners owners = find_owners(light.charts, placements, options, context);
  page.contested_texels = owners.contested;
  std::mutex counting;
  std::size_t done = 0;
  parallel_for(context, placements.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !context.cancelled(); ++i) {
      const ChartBox box(placements[i], options);
      TexelGrid texels = bake_box(display, box);
      const std::size_t filled = fill_unknown(texels);
      const OwnTexels own{box, owners.runs[i]};
      copy_own(texels, own, page.display, quantize_lanes);
      const std::size_t covered = texels.rgb.size() - filled;
      if (linear) {
        texels = bake_box(*linear, box);
        fill_unknown(texels);
        copy_own(texels, own, page.linear, [](Lanes v) { return v; });
      }
      const std::lock_guard lock(counting);
      page.triangles += light.charts.charts[placements[i].chart].triangle_count;
      page.covered_texels += covered;
      context.report("baking",
                     static_cast<double>(++done) / static_cast<double>(placements.size()));
    }
  });
  if (context.cancelled()) return Status::cancelled();
  // Lookups at the guarded mip levels never read texels that no chart owns. But viewers build the
  // whole mip chain, and black texels there would draw dark lines along distant seams.
  fill_unknown(owners.taken, page.display);
  if (owners.contested > 0) context.say(contested_text(owners, options.mip_levels));
  return page;
}

}  // namespace atlas
