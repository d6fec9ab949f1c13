#include "libatlas/pipeline/page_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/progress.h"

namespace atlas {
namespace {

// The outlines of charts, as the packer takes them: corners in texels at scale 1, and triangles
// whose corners are numbered within their chart.
struct Outlines {
  std::vector<Vec2d> corners;
  std::vector<std::uint32_t> triangles;
  std::vector<ChartShape> shapes;

  Outlines(const ChartSet& set, std::span<const Vec2d> density) : corners(set.uvs.size()) {
    triangles.reserve(3 * set.chart_triangles.size());
    for (std::size_t c = 0; c < set.charts.size(); ++c) {
      const Chart& chart = set.charts[c];
      for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
        corners[i] = {set.uvs[i].x * density[c].x, set.uvs[i].y * density[c].y};
      }
      for (const std::size_t t : triangles_of(set, chart)) {
        for (int k = 0; k < 3; ++k) {
          triangles.push_back(set.triangle_uv[3 * t + k] - chart.first_uv);
        }
      }
    }
    for (const Chart& chart : set.charts) {
      shapes.push_back({std::span(corners).subspan(chart.first_uv, chart.uv_count),
                        std::span(triangles).subspan(3 * std::size_t(chart.first_triangle),
                                                     3 * std::size_t(chart.triangle_count))});
    }
  }
};

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

ChartPlacement outlined(const FitPlacement& from, const LayoutOptions& options) {
  ChartPlacement to;
  to.outlined = true;
  to.offset = from.offset;
  to.cosine = std::cos(from.angle);
  to.sine = std::sin(from.angle);
  to.x = from.box.x + options.padding;
  to.y = from.box.y + options.padding;
  to.width = from.box.width - 2 * options.padding;
  to.height = from.box.height - 2 * options.padding;
  return to;
}

double uv_utilization(const ChartSet& charts, const PageLayout& layout) {
  double area = 0, page_area = 0;
  for (const ChartPlacement& p : layout.placements) {
    area += charts.charts[p.chart].distortion.uv_area * p.texels_per_unit.x * p.texels_per_unit.y;
  }
  for (const Extent& page : layout.pages) page_area += double(page.area());
  return page_area > 0 ? area / page_area : 0;
}

// Returns the area of the charts at scale 1, in texels.
double full_texels(const ChartSet& charts, std::span<const Vec2d> texels_per_unit) {
  double texels = 0;
  for (std::size_t c = 0; c < charts.charts.size(); ++c)
    texels += charts.charts[c].distortion.uv_area * texels_per_unit[c].x * texels_per_unit[c].y;
  return texels;
}

// Returns the error for charts that do not fit, in the words of this stage.
Status no_room(const ChartSet& charts, const LayoutOptions& options) {
  return {ErrorCode::no_solution,
          fmt::format("{} charts do not fit {} page{} of {} x {} even as small as allowed ({})",
                      charts.charts.size(), options.pages, options.pages == 1 ? "" : "s",
                      options.page_size, options.page_size, options.remedy)};
}

// Limits of what PackPreset::best tries: the number of layouts, and the number of charts in all of
// them together. This takes some seconds. Nineteen poorly filled sets of charts filled 0.503 of
// their pages with 36 000 charts, and 0.505 with 50 000, in a third more time.
constexpr std::uint64_t kBestLayouts = 8000, kBestCharts = 56000;

// The problem for the packer, by boxes or by outlines as options.outlines says.
struct Problem {
  const ChartSet& charts;
  std::span<const Vec2d> texels_per_unit;
  const LayoutOptions& options;
  std::vector<FitItem> items;
  std::optional<Outlines> outlines;
  FitOptions fit;

  Problem(const WantedCharts& wanted, const LayoutOptions& how)
      : charts(wanted.charts),
        texels_per_unit(wanted.texels_per_unit),
        options(how),
        items(charts.charts.size()) {
    for (std::size_t c = 0; c < items.size(); ++c) {
      items[c] = {charts.charts[c].size.x * texels_per_unit[c].x,
                  charts.charts[c].size.y * texels_per_unit[c].y};
    }
    fit.pages = options.pages;
    fit.page_size = options.page_size;
    fit.padding = options.padding;
    fit.alignment = options.alignment;
    fit.minimum_side = options.minimum_side;
    fit.allow_rotation = options.allow_rotation;
    fit.preset = options.preset;
    // Effort is limited instead of time, because a limit on time would make the result depend on
    // how busy the machine is.
    fit.effort = std::clamp<std::uint64_t>(kBestCharts / std::max<std::size_t>(1, items.size()), 1,
                                           kBestLayouts);
    fit.free_aspect = options.free_aspect;
    fit.square = options.square;
    fit.wanted_fill = options.wanted_fill;
    fit.tried = options.tried;
    fit.press_pages = options.press_pages;
    if (options.outlines) {
      outlines.emplace(charts, texels_per_unit);
      fit.shapes = outlines->shapes;
    }
  }
};

// Converts the packer's result to the terms of this stage.
PageLayout layout_of(FitResult fitted, const Problem& problem) {
  const LayoutOptions& options = problem.options;
  PageLayout layout;
  layout.outlines = options.outlines && !fitted.boxes;
  layout.scale = fitted.scale;
  layout.pages = std::move(fitted.pages);
  layout.utilization = fitted.utilization;
  layout.grouping = std::move(fitted.grouping);
  layout.placements.resize(fitted.placements.size());
  for (std::size_t c = 0; c < fitted.placements.size(); ++c) {
    const FitPlacement& from = fitted.placements[c];
    const FitItem& item = problem.items[c];
    ChartPlacement& to = layout.placements[c];
    to = layout.outlines ? outlined(from, options) : boxed(from, options);
    to.chart = std::uint32_t(c);
    to.page = std::int32_t(from.page);
    const Vec2d wanted = problem.texels_per_unit[c];
    to.texels_per_unit =
        layout.outlines
            ? Vec2d{wanted.x * from.scale, wanted.y * from.scale}
            : Vec2d{scaled_density(wanted.x, item.width, layout.scale, options.minimum_side),
                    scaled_density(wanted.y, item.height, layout.scale, options.minimum_side)};
  }
  layout.layouts = fitted.layouts;
  layout.uv_utilization = uv_utilization(problem.charts, layout);
  const double texels = full_texels(problem.charts, problem.texels_per_unit);
  if (texels > 0) layout.with_lost_room = 1 + fitted.lost_area / texels;
  return layout;
}

// Packs by boxes, and by outlines if options.outlines allows them and they may win.
Result<PageLayout> lay_out(const WantedCharts& wanted, const LayoutOptions& options,
                           const Context& context) {
  const Problem problem(wanted, options);
  Result<FitResult> fitted = options.outlines
                                 ? fit_boxes_or_outlines(problem.items, problem.fit, context)
                                 : fit_pages(problem.items, problem.fit, context);
  if (!fitted.ok()) {
    const bool full = fitted.status().code() == ErrorCode::no_solution;
    return full ? no_room(wanted.charts, options) : fitted.status();
  }
  return layout_of(std::move(*fitted), problem);
}

// A page for uvs alone is packed again with PackPreset::best if its charts, with their small holes
// and narrow bays, cover less of it than kPoor, and with their gutters less than kPoorWithGutters.
// Gutters take most of small pages, where packing again does not help. This concerns two or three
// of a hundred models. All packing of 21 such pages took 0.5 to 6 s each.
constexpr double kPoor = 0.66, kPoorWithGutters = 0.7;

// Pages with more charts than this, which are not pressed together, are not packed again: with 900
// loose triangles, packing again won 1 % in 7 s. Neither is a page with a single chart, which has
// been turned in all ways already.
constexpr std::size_t kMostCharts = 128;

// Returns the share of the pages that charts take with their gutters, which are estimated from the
// size of their boxes.
double taken(const ChartSet& charts, const PageLayout& layout, const LayoutOptions& options) {
  double texels = 0, page_texels = 0;
  for (const ChartPlacement& p : layout.placements) {
    const Chart& chart = charts.charts[p.chart];
    const Vec2d density = p.texels_per_unit;
    const double around = 2 * (chart.size.x * density.x + chart.size.y * density.y);
    texels += chart.distortion.uv_area * density.x * density.y +
              options.padding * (around + 4.0 * options.padding);
  }
  for (const Extent& page : layout.pages) page_texels += double(page.area());
  return page_texels > 0 ? texels / page_texels : 0;
}

// Returns whether packing a page again with more effort may be worth it. It is not if even then the
// page would be less full than the caller wants.
bool worth_more_work(const ChartSet& charts, const PageLayout& layout,
                     const LayoutOptions& options) {
  return options.free_aspect && options.preset == PackPreset::standard && layout.won == 0 &&
         charts.charts.size() > 1 && charts.charts.size() <= kMostCharts &&
         layout.with_lost_room * layout.uv_utilization < kPoor &&
         options.most_won * layout.uv_utilization >= options.wanted_fill &&
         taken(charts, layout, options) < kPoorWithGutters;
}

// Packs by boxes, by outlines if these may win, and with more effort if that may win much.
Result<PageLayout> lay_out_better(const WantedCharts& wanted, const LayoutOptions& options,
                                  const Context& context) {
  constexpr double kFirst = 0.6;  // share of the progress
  Result<PageLayout> best = lay_out(wanted, options, part_of_stage(context, "packing", 0, kFirst));
  if (!best.ok() || !options.more_work) return best;
  return work_on_layout(wanted, options, std::move(*best),
                        part_of_stage(context, "packing", kFirst, 1));
}

}  // namespace

double filling_density(const ChartSet& charts, double texels) {
  double area = 0;
  for (const Chart& chart : charts.charts) area += chart.distortion.uv_area;
  return area > 0 ? std::sqrt(texels / area) : 1;
}

Result<PageLayout> lay_out_pages(const ChartSet& charts, std::span<const Vec2d> texels_per_unit,
                                 const LayoutOptions& options, const Context& context) {
  if (texels_per_unit.size() != charts.charts.size())
    return Status(ErrorCode::bad_input, fmt::format("{} texel densities for {} charts",
                                                    texels_per_unit.size(), charts.charts.size()));
  for (std::size_t c = 0; c < texels_per_unit.size(); ++c) {
    const Vec2d density = texels_per_unit[c];
    if (!(density.x > 0 && density.y > 0) || !std::isfinite(density.x + density.y))
      return Status(ErrorCode::bad_input,
                    fmt::format("chart {}: texel density {} x {} (must be above 0 and finite)", c,
                                density.x, density.y));
  }
  Result<PageLayout> layout = lay_out_better({charts, texels_per_unit}, options, context);
  if (context.cancelled()) return Status::cancelled();
  context.report("packing", 1);
  return layout;
}

Result<PageLayout> press_layout(const WantedCharts& wanted, const LayoutOptions& options,
                                const PageLayout& unpressed, const Context& context) {
  if (!unpressed.outlines)
    return lay_out_pages(wanted.charts, wanted.texels_per_unit, options, context);
  const Problem problem(wanted, options);
  FitResult fitted;
  fitted.scale = unpressed.scale;
  fitted.pages = unpressed.pages;
  fitted.grouping = unpressed.grouping;
  for (const ChartPlacement& p : unpressed.placements) {
    fitted.placements.emplace_back().page = std::uint32_t(p.page);
  }
  Result<FitResult> pressed = press_fit(std::move(fitted), problem.items, problem.fit, context);
  if (!pressed.ok()) return pressed.status();
  if (!(pressed->scale > unpressed.scale)) return unpressed;
  return layout_of(std::move(*pressed), problem);
}

Result<PageLayout> work_on_layout(const WantedCharts& wanted, const LayoutOptions& options,
                                  PageLayout standard, const Context& context) {
  if (!options.outlines || !worth_more_work(wanted.charts, standard, options)) return standard;
  LayoutOptions harder = options;
  harder.preset = PackPreset::best;
  harder.tried = standard.layouts;
  harder.wanted_fill = std::max(options.wanted_fill, standard.uv_utilization);
  const Problem problem(wanted, harder);
  Result<FitResult> more = fit_pages(problem.items, problem.fit, context);
  if (context.cancelled()) return Status::cancelled();
  const double before = standard.uv_utilization;
  if (more.ok()) {
    PageLayout fuller = layout_of(std::move(*more), problem);
    if (fuller.uv_utilization > before) standard = std::move(fuller);
  }
  standard.won = before > 0 ? standard.uv_utilization / before : 1;
  return standard;
}

}  // namespace atlas
