// Finds and widens gaps between parts of a chart that are so narrow that texels would mix both
// sides.
#pragma once

#include <cstddef>
#include <span>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas {

// Lengths are relative to the clearance of the chart that the border belongs to. In texels they are
// twice that, if a clearance is two texels.
struct GapReport {
  std::size_t charts = 0;  // charts that were changed
  double border = 0;       // of the charts that were examined; seams count on both sides
  // The part of it that is too close to another part.
  double near_before = 0, near_after = 0;
};

struct GapLimits {
  // One per chart, in units of its uvs, such as the distance across two texels; >= 0. Charts whose
  // clearance is 0, or more than a fifth of the square root of their area, are not examined.
  std::span<const double> clearance = {};
  double max_stretch = 1.25;  // > 1, see ChartOptions::max_stretch
};

// Measures how much of the charts' borders is closer than the clearance (see GapLimits) to another
// part of the same chart, although both are far apart on the surface: more than three clearances.
// Changes nothing. Errors: bad_input (not one clearance per chart, or one below 0 or not a number;
// charts of another mesh, or whose ranges and indices contradict each other; materials or densities
// that make_charts refuses); cancelled.
Result<GapReport> measure_gaps(const MeshView& mesh, std::span<const double> clearance,
                               const ChartSet& charts, const Context& context);

// Widens such gaps by moving the border back on both sides, as far as the chart stays injective and
// within limits.max_stretch (or its present stretch). Charts keep their triangles and seams; their
// uvs, size and distortion change a little, and so does the total. Given charts (Chart::kept) are
// not examined. The result is the same for every thread count. Errors: bad_input (as measure_gaps)
// and bad_option (max_stretch), with the charts unchanged; cancelled, with some of them widened.
Result<GapReport> widen_gaps(const MeshView& mesh, const GapLimits& limits, ChartSet& charts,
                             const Context& context);

}  // namespace atlas
