// Internal: the area of holes and bays in charts' outlines that no packing could use.
#pragma once

#include <span>

#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

// Returns the area of all small holes together in which no chart could lie, in square texels at
// scale 1. A hole is small if its area is less than a thirtieth of the area of all charts; cutting
// a chart open through such a hole would gain little. The area of the charts that are smaller than
// the largest small hole is subtracted, since these charts could lie in holes.
double lost_to_holes(std::span<const ChartOutline> outlines);

// Returns the same for narrow bays, which are open to the outside, like the space between the teeth
// of a comb or between the windings of a spiral. A bay is narrow if its width is less than a
// fortieth of the side of a square that all charts would fill, or less than four gutters. The area
// of the charts that are narrower than this width is subtracted. `gutter` is the width of the
// gutter around each chart, in texels at scale 1.
double lost_to_bays(std::span<const ChartOutline> outlines, double gutter, const Context& context);

}  // namespace atlas::pack
