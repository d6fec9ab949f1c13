// Internal: the middle that a cell's fan of coarse triangles is drawn around.
#pragma once

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// Moves the centre of a fan whose flat outline is not seen from there in full into the outline's
// kernel, if it has one: what is folded at the start is refused by every trial, and such a cell
// would stay a chart of its own. The kernel is the square around the outline clipped by its edges
// (Lee and Preparata 1979 do it in linear time).
void centre_fan(const CoarseMesh& mesh, CoarseCell& cell);

}  // namespace atlas
