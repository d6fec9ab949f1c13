#include "libatlas/unwrap/layout_effort.h"

#include <fmt/format.h>

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

}  // namespace

Result<WorkedLayout> lay_out_charts(const WantedCharts& wanted, const LayoutEffort& options,
                                    const Context& context) {
  if (Status s = check(wanted); !s.ok()) return s;
  Result<WorkedLayout> layout = lay_out(wanted, options, part_of_stage(context, "packing"));
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

}  // namespace atlas
