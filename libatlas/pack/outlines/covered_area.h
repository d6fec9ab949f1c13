// Internal: measures how far a chart overlaps itself.
#pragma once

#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

// Returns the area that the chart covers as a share of the sum of its triangles' areas. The share
// is 1 if sixteen lines across the chart cross no overlap; otherwise it is exact to about a
// hundredth. Uvs that are given with a mesh often overlap many times over.
double covered_share(const ChartOutline& outline);

}  // namespace atlas::pack
