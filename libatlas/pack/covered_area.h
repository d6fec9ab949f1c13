// Internal: how much of a chart lies on itself.
#pragma once

#include "libatlas/pack/chart_outline.h"

namespace atlas::pack {

// The area that the chart covers as a share of the sum of its triangles' areas: 1 where none
// overlap, as far as sixteen lines across it tell, else within a hundredth or so. Given uvs often
// lie on each other many times over.
double covered_share(const ChartOutline& outline);

}  // namespace atlas::pack
