// Charts whose parts come so near each other on the page that texels would mix them.
#pragma once

#include <cstddef>
#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

// Lengths are in clearances of the chart that the border belongs to: twice as many texels, where a
// clearance is two of them.
struct GapReport {
  std::size_t charts = 0;  // that were changed
  double border = 0;       // of the charts that were looked at; seams count on both sides
  double near_before = 0, near_after = 0;  // of it, what is too near to another part
};

struct GapLimits {
  std::span<const double> clearance = {};  // 1 a chart, in units of its uvs; 0: not looked at
  double max_stretch = 1.25;               // > 1: charts may be stretched so far, see ChartOptions
};

// How much of the charts' borders is nearer to another part of the same chart than its clearance
// (as in GapLimits), though the two are far apart on the surface:
// more than three clearances. Charts whose clearance is more than a fifth of the root of their area
// are not looked at. Nothing is changed.
GapReport measure_gaps(const MeshView& mesh, std::span<const double> clearance,
                       const ChartSet& charts, const Context& context);

// Opens such gaps: the border is drawn back on both sides, so far as the chart stays within
// limits.max_stretch (or what it stretches already) and injective. Charts keep their triangles and
// seams; uvs, size and distortion change a little, the total as well. Given charts (Chart::kept)
// are not looked at either, and where the work is cancelled some charts may be left. The result is
// the same for every thread count.
GapReport widen_gaps(const MeshView& mesh, const GapLimits& limits, ChartSet& charts,
                     const Context& context);

}  // namespace atlas
