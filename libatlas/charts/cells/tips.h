// Internal: the few points where a surface that unrolls elsewhere does not.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// By how much the angles around the vertex where h starts fall short of a full turn, or exceed it
// (negative), radians in [-pi, pi]: whole turns are left out. 0 at the mesh's border.
double angle_defect(const Topology& topology, std::uint32_t h);

// Apexes of cones, corners of boxes: half-edges, each starting at a vertex with an angle defect, in
// pieces that have none at nearly all others. Linear in the number of triangles; curved pieces are
// told by a few.
std::vector<std::uint32_t> find_tips(const Topology& topology);

// Divides the cells that lie all around a tip in two, for what unrolls has tips on its border only.
void divide_at_tips(const Topology& topology, const std::vector<std::uint32_t>& tips, Cells& cells);

}  // namespace atlas
