#include "libatlas/unwrap/layout_effort.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libatlas/core/progress.h"
#include "libatlas/pack/fitting/fit_search.h"
#include "libatlas/unwrap/layout_problem.h"
#include "libatlas/unwrap/least_room.h"

namespace atlas {
namespace {

Status check(const WantedCharts& wanted) {
  if (wanted.texels_per_unit.size() != wanted.charts.charts.size())
    return Status(ErrorCode::bad_input,
                  fmt::format("{} texel densities for {} charts", wanted.texels_per_unit.size(),
                              wanted.charts.charts.size()));
  for (std::size_t c = 0; c < wanted.texels_per_unit.size(); ++c) {
    const Vec2d density = wanted.texels_per_unit[c];
    if (!(density.x > 0 && density.y > 0) || !std::isfinite(density.x + density.y))
      return Status(ErrorCode::bad_input,
                    fmt::format("chart {}: texel density {} x {} (must be above 0 and finite)", c,
                                density.x, density.y));
  }
  return {};
}

// Packs by boxes, and by outlines if options.outlines allows them and they may win.
Result<WorkedLayout> lay_out(const WantedCharts& wanted, const LayoutEffort& options,
                             const Context& context) {
  const LayoutProblem problem(wanted, options);
  Result<FitResult> fitted =
      options.outlines ? pack::search_boxes_or_outlines(problem.items, problem.fit, context)
                       : pack::search_fit(problem.items, problem.fit, context);
  if (!fitted.ok()) {
    const bool full = fitted.status().code() == ErrorCode::no_solution;
    return full ? no_room(wanted.charts, options) : fitted.status();
  }
  return layout_of(std::move(*fitted), problem);
}

// A page for uvs alone is packed again with PackPreset::best if its charts, with their small holes
// and narrow bays, cover less of it than kPoorPage, and with their gutters less than
// kPoorPageWithGutters. Gutters take most of small pages, where packing again does not help. This
// concerns two or three of a hundred models. All packing of 21 such pages took 0.5 to 6 s each.
constexpr double kPoorPage = 0.66, kPoorPageWithGutters = 0.7;

// Pages with more charts than this, which are not pressed together, are not packed again: with 900
// loose triangles, packing again won 1 % in 7 s. Neither is a page with a single chart, which has
// been turned in all ways already.
constexpr std::size_t kMostCharts = 128;

// Returns the share of the pages that charts take with their gutters, which are estimated from the
// size of their boxes.
double taken(const ChartSet& charts, const WorkedLayout& layout, const LayoutEffort& options) {
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
bool worth_more_work(const ChartSet& charts, const WorkedLayout& layout,
                     const LayoutEffort& options) {
  return options.free_aspect && options.preset == PackPreset::standard && layout.won == 0 &&
         charts.charts.size() > 1 && charts.charts.size() <= kMostCharts &&
         layout.with_lost_room * layout.uv_utilization < kPoorPage &&
         options.most_won * layout.uv_utilization >= options.wanted_fill &&
         taken(charts, layout, options) < kPoorPageWithGutters;
}

// Packs by boxes, by outlines if these may win, and with more effort if that may win much.
Result<WorkedLayout> lay_out_better(const WantedCharts& wanted, const LayoutEffort& options,
                                    const Context& context) {
  constexpr double kFirst = 0.6;  // share of the progress
  Result<WorkedLayout> best =
      lay_out(wanted, options, part_of_stage(context, "packing", 0, kFirst));
  if (!best.ok() || !options.more_work) return best;
  return work_on_layout(wanted, options, std::move(*best),
                        part_of_stage(context, "packing", kFirst, 1));
}

}  // namespace

Result<WorkedLayout> lay_out_charts(const WantedCharts& wanted, const LayoutEffort& options,
                                    const Context& context) {
  if (Status s = check(wanted); !s.ok()) return s;
  Result<WorkedLayout> layout = lay_out_better(wanted, options, context);
  if (context.cancelled()) return Status::cancelled();
  context.report("packing", 1);
  return layout;
}

Result<WorkedLayout> press_layout(const WantedCharts& wanted, const LayoutEffort& options,
                                  const WorkedLayout& unpressed, const Context& context) {
  if (!unpressed.outlines) return lay_out_charts(wanted, options, context);
  const LayoutProblem problem(wanted, options);
  FitResult fitted;
  fitted.scale = unpressed.scale;
  fitted.pages = unpressed.pages;
  fitted.grouping = unpressed.grouping;
  for (const ChartPlacement& p : unpressed.placements) {
    fitted.placements.emplace_back().page = std::uint32_t(p.page);
  }
  Result<FitResult> pressed =
      pack::press_fit(std::move(fitted), problem.items, problem.fit, context);
  if (!pressed.ok()) return pressed.status();
  if (!(pressed->scale > unpressed.scale)) return unpressed;
  return layout_of(std::move(*pressed), problem);
}

Result<WorkedLayout> work_on_layout(const WantedCharts& wanted, const LayoutEffort& options,
                                    WorkedLayout standard, const Context& context) {
  if (!options.outlines || !worth_more_work(wanted.charts, standard, options)) return standard;
  LayoutEffort harder = options;
  harder.preset = PackPreset::best;
  harder.wanted_fill = std::max(options.wanted_fill, standard.uv_utilization);
  LayoutProblem problem(wanted, harder);
  problem.fit.tried = standard.layouts;
  Result<FitResult> more = pack::search_fit(problem.items, problem.fit, context);
  if (context.cancelled()) return Status::cancelled();
  const double before = standard.uv_utilization;
  if (more.ok()) {
    WorkedLayout fuller = layout_of(std::move(*more), problem);
    if (fuller.uv_utilization > before) standard = std::move(fuller);
  }
  standard.won = before > 0 ? standard.uv_utilization / before : 1;
  return standard;
}

}  // namespace atlas
