// Internal: rows of needles, as coarse sweeps along a path have them.
#pragma once

#include "libatlas/charts/cells/cell_plan.h"
#include "libatlas/charts/cells/regions.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Finds the rows of the pieces that consist mostly of needles, that is, of triangles several times
// as high as wide. A row is a connected part of such a piece that does not go on across the short
// edges of its needles, end to end. A cell that does has an outline with teeth as long as a needle,
// which no fan represents. None are found where rows would divide a piece into more regions than it
// has planned cells. Linear in the number of triangles.
Regions find_rows(const Topology& topology, const CellPlan& plan);

}  // namespace atlas
