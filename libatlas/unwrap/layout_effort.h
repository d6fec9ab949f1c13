// Internal: lays out pages for callers that compare several ways to cut charts, and spend effort
// only on the one that they choose.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

struct LayoutEffort : LayoutOptions {
  bool press_pages = true;          // as in FitOptions
  double wanted_fill = 0;           // as in pack::FitSearchOptions
  double first_round = 1;           // as in pack::FitSearchOptions
  std::uint32_t max_packings = 25;  // as in FitOptions
  // As in pack::FitSearchOptions, also for other presets.
  double deadline = std::numeric_limits<double>::infinity();
};

struct WorkedLayout : PageLayout {
  // The area of the charts together with their small holes and narrow bays, which are lost because
  // no chart could lie in them, divided by the area of the charts alone. It is 1 if outlines were
  // not tried.
  double with_lost_room = 1;
};

// The charts to place, and their densities.
struct WantedCharts {
  const ChartSet& charts;
  std::span<const Vec2d> texels_per_unit = {};  // one per chart, > 0
};

// Does the same as lay_out_pages(), which calls it. Errors: those of lay_out_pages().
Result<WorkedLayout> lay_out_charts(const WantedCharts& wanted, const LayoutEffort& options,
                                    const Context& context);

// Does the same as lay_out_charts() if `unpressed` is what it returned without press_pages for the
// same charts and options. This is not checked. The pages of outlines are then only pressed, and
// not searched for again. Errors: those of lay_out_charts().
Result<WorkedLayout> press_layout(const WantedCharts& wanted, const LayoutEffort& options,
                                  const WorkedLayout& unpressed, const Context& context);

}  // namespace atlas
