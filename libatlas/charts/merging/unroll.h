// Internal: cells that can be laid flat as paper can.
#pragma once

#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Finds the bent cells around whose vertices the angles sum to a full turn, those of the rim
// included: parts of cylinders, cones and other developable surfaces. Their triangles are laid flat
// one beside the other, edge on edge, which stretches nothing; sets CoarseCell::unrolls and
// flat_centre, and CoarseMesh::flat_slot. Two such cells fit each other along whatever border they
// share, so merging need not try them on the coarse mesh, whose fans are too coarse for ribbons
// that are narrower than a cell is bent. Cells in one plane count
// only where they touch bent ones: coplanar() and fans serve them as well.
// Curved cells are told by their first vertex, so this costs as much as there is to unroll.
void unroll_cells(const Topology& topology, const Cells& cells, CoarseMesh& mesh);

// Lays a connected chart without densities flat, triangle by triangle. False as soon as one does
// not fit those beside it, or is thinner than min_altitude: nearly all charts that cannot be
// unrolled show that within a few steps. What comes out may overlap itself, and stretches by what
// rounding of coordinates adds up to.
bool unroll_chart(const LocalChart& chart, double min_altitude, std::vector<Vec2d>& uvs);

}  // namespace atlas
