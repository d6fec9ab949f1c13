// Internal: lays cells and charts flat that can be unrolled as paper can.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Finds the bent cells around whose vertices, including those of the rim, the angles sum to a full
// turn: parts of cylinders, cones and other developable surfaces. Lays their triangles flat, edge
// on edge, which stretches nothing, and sets CoarseCell::unrolls and flat_centre, and
// CoarseMesh::flat_slot. Two such cells fit each other along any border that they share. Merging
// therefore need not try them on the coarse mesh, whose fans are too coarse for ribbons narrower
// than their cells are bent. Cells in one plane are included only where they touch bent ones;
// elsewhere coplanar() and fans serve them as well. Curved cells are recognized by their first
// vertices, so the time depends on how much there is to unroll.
// `tips` are those of find_tips().
void unroll_cells(const Topology& topology, const Cells& cells, std::span<const std::uint32_t> tips,
                  CoarseMesh& mesh);

// Lays a connected chart without densities flat, triangle by triangle. Returns false as soon as a
// triangle does not fit its neighbours, or is thinner than min_altitude; nearly all charts that
// cannot be unrolled fail within a few steps. The result may overlap itself, and is stretched by
// the accumulated rounding of coordinates.
bool unroll_chart(const LocalChart& chart, double min_altitude, std::vector<Vec2d>& uvs);

}  // namespace atlas
