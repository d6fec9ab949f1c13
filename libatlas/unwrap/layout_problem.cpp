#include "libatlas/unwrap/layout_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

// What PackPreset::best may do, in rounds of `standard`.
constexpr double kBestRounds = 15;

// Returns the density that the common scale leaves for a box's side. Sides stop shrinking at the
// smallest length that is allowed.
double scaled_density(double density, double side, double scale, double minimum_side) {
  const double floor_side = std::min(minimum_side, side);
  return side > 0 ? density * std::max(scale, floor_side / side) : density * scale;
}

ChartPlacement boxed(const FitPlacement& from, const LayoutOptions& options) {
  ChartPlacement to;
  to.width = from.rotated ? from.content_height : from.content_width;
  to.height = from.rotated ? from.content_width : from.content_height;
  to.x = from.box.x + options.padding;
  to.y = from.box.y + options.padding;
  turn_in_box(to, from.rotated);
  return to;
}

// Returns the area of the charts at scale 1, in texels.
double full_texels(const ChartSet& charts, std::span<const Vec2d> texels_per_unit) {
  double texels = 0;
  for (std::size_t c = 0; c < charts.charts.size(); ++c)
    texels += charts.charts[c].distortion.uv_area * texels_per_unit[c].x * texels_per_unit[c].y;
  return texels;
}

}  // namespace

ChartPlacement outlined_placement(const Rect& box, double angle, Vec2d offset,
                                  std::int32_t padding) {
  ChartPlacement to;
  to.outlined = true;
  to.offset = offset;
  to.cosine = portable::cos(angle);
  to.sine = portable::sin(angle);
  to.x = box.x + padding;
  to.y = box.y + padding;
  to.width = box.width - 2 * padding;
  to.height = box.height - 2 * padding;
  return to;
}

ChartOutlines::ChartOutlines(const ChartSet& set, std::span<const Vec2d> density)
    : corners(set.uvs.size()) {
  triangles.reserve(3 * set.chart_triangles.size());
  for (std::size_t c = 0; c < set.charts.size(); ++c) {
    const Chart& chart = set.charts[c];
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
      corners[i] = {set.uvs[i].x * density[c].x, set.uvs[i].y * density[c].y};
    }
    for (const std::size_t t : triangles_of(set, chart)) {
      const std::uint32_t* const uvs = &set.triangle_uv[3 * t];
      for (const std::uint32_t uv : from_lowest({uvs[0], uvs[1], uvs[2]}))
        triangles.push_back(uv - chart.first_uv);
    }
  }
  for (const Chart& chart : set.charts) {
    shapes.push_back({std::span(corners).subspan(chart.first_uv, chart.uv_count),
                      std::span(triangles).subspan(3 * std::size_t(chart.first_triangle),
                                                   3 * std::size_t(chart.triangle_count))});
  }
}

FitOptions box_fit_options(const LayoutOptions& options) {
  FitOptions fit{options};
  fit.minimum_side = options.minimum_side;
  return fit;
}

FitItem chart_box(const Chart& chart, Vec2d texels_per_unit) {
  return {chart.size.x * texels_per_unit.x, chart.size.y * texels_per_unit.y};
}

LayoutProblem::LayoutProblem(const WantedCharts& wanted, const LayoutEffort& how)
    : charts(wanted.charts),
      texels_per_unit(wanted.texels_per_unit),
      options(how),
      items(charts.charts.size()) {
  for (std::size_t c = 0; c < items.size(); ++c)
    items[c] = chart_box(charts.charts[c], texels_per_unit[c]);
  static_cast<FitOptions&>(fit) = box_fit_options(options);
  // Unless time was asked for, effort is limited instead, because a limit on time makes the result
  // depend on how busy the machine is.
  fit.time_budget = options.time_budget;
  fit.deadline = options.deadline;
  if (std::isinf(options.time_budget))
    fit.effort = std::uint64_t(
        std::ceil(kBestRounds * pack::round_work(items.size()) / pack::kWordsOfEffort));
  fit.free_aspect = options.free_aspect;
  fit.wanted_fill = options.wanted_fill;
  fit.first_round = options.first_round;
  fit.press_pages = options.press_pages;
  fit.max_packings = options.max_packings;
  if (options.outlines) {
    outlines.emplace(charts, texels_per_unit);
    fit.shapes = outlines->shapes;
  }
}

double uv_utilization(const ChartSet& charts, const PageLayout& layout) {
  double area = 0, page_area = 0;
  for (const ChartPlacement& p : layout.placements) {
    area += charts.charts[p.chart].distortion.uv_area * p.texels_per_unit.x * p.texels_per_unit.y;
  }
  for (const Extent& page : layout.pages) page_area += double(page.area());
  return page_area > 0 ? area / page_area : 0;
}

WorkedLayout layout_of(FitResult fitted, const LayoutProblem& problem) {
  const LayoutOptions& options = problem.options;
  WorkedLayout layout;
  layout.outlines = options.outlines && !fitted.boxes;
  layout.scale = fitted.scale;
  layout.pages = std::move(fitted.pages);
  layout.grouping = std::move(fitted.grouping);
  layout.placements.resize(fitted.placements.size());
  for (std::size_t c = 0; c < fitted.placements.size(); ++c) {
    const FitPlacement& from = fitted.placements[c];
    const FitItem& item = problem.items[c];
    ChartPlacement& to = layout.placements[c];
    to = layout.outlines ? outlined_placement(from.box, from.angle, from.offset, options.padding)
                         : boxed(from, options);
    to.chart = std::uint32_t(c);
    to.page = std::int32_t(from.page);
    const Vec2d wanted = problem.texels_per_unit[c];
    to.texels_per_unit =
        layout.outlines
            ? Vec2d{wanted.x * from.scale, wanted.y * from.scale}
            : Vec2d{scaled_density(wanted.x, item.width, layout.scale, options.minimum_side),
                    scaled_density(wanted.y, item.height, layout.scale, options.minimum_side)};
  }
  layout.uv_utilization = uv_utilization(problem.charts, layout);
  const double texels = full_texels(problem.charts, problem.texels_per_unit);
  if (texels > 0) layout.with_lost_room = 1 + fitted.lost_area / texels;
  return layout;
}

}  // namespace atlas
