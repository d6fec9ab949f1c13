// Internal: lays out pages for callers that compare several ways to cut charts, and spend effort
// only on pages that may become full enough.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

struct LayoutEffort : LayoutOptions {
  bool press_pages = true;  // as in FitOptions
  double wanted_fill = 0;   // as in pack::FitSearchOptions
  bool more_work = true;    // spend more effort on a poorly filled page; see work_on_layout()
  std::uint32_t max_packings = 25;  // as in FitOptions
  double most_won = 1.1;  // by which factor more effort may make a poorly filled page fuller
};

struct WorkedLayout : PageLayout {
  // The area of the charts together with their small holes and narrow bays, which are lost because
  // no chart could lie in them, divided by the area of the charts alone. It is 1 if outlines were
  // not tried.
  double with_lost_room = 1;
  std::uint64_t layouts = 0;  // how many layouts of outlines were tried
  // The factor by which more effort made a poorly filled page fuller; 0 if none was spent.
  double won = 0;
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

// Packs a poorly filled page again with more effort, if it may then be filled to wanted_fill.
// `standard` is what lay_out_charts() returned without more_work for the same charts and options.
// This is not checked. Returns the better layout of the two. Errors: cancelled.
Result<WorkedLayout> work_on_layout(const WantedCharts& wanted, const LayoutEffort& options,
                                    WorkedLayout standard, const Context& context);

}  // namespace atlas
