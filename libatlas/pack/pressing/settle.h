// Internal: replaces rigid bodies that nearly touch by exact masks on the page's cells.
#pragma once

#include <limits>
#include <span>

#include "libatlas/pack/pressing/press.h"

namespace atlas::pack {

// Charts, and where they should lie at this scale.
struct SettleCharts {
  std::span<const ChartOutline> outlines;
  std::span<const SettleTarget> targets;  // one per chart
  double scale = 1;
  // Limit for moving charts apart, in words (about 2 ns each). After that they are placed one after
  // another.
  double work = std::numeric_limits<double>::infinity();
};

// Places every chart on free cells as near to its target as possible, at a scale below that of the
// targets that is as large as possible, and then moves the charts together, down and to the left.
// Small charts may go elsewhere, and specks go into the gaps that are left. If no scale works, the
// result has scale 0.
PressedPage settle(const SettleCharts& charts, const FitOptions& options, const Context& context);

// Does the same at exactly this scale, which is at most that of the targets. If charts find no
// place, the result has scale 0.
PressedPage settle_at(double scale, const SettleCharts& charts, const FitOptions& options,
                      const Context& context);

}  // namespace atlas::pack
