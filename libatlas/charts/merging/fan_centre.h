// Internal: chooses the centre of a cell's fan of coarse triangles.
#pragma once

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// If the flat outline of a fan is not fully visible from its centre, moves the centre into the
// outline's kernel, if that exists. Every trial refuses what starts with flips, and such a cell
// would stay a chart of its own. The kernel is found by clipping the square around the outline with
// each of the outline's edges (Lee and Preparata 1979 do it in linear time).
void centre_fan(const CoarseMesh& mesh, CoarseCell& cell);

}  // namespace atlas
