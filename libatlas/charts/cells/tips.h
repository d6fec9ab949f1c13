// Internal: tips, the few points where a surface that is developable elsewhere is not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// The angle defect, in radians, from which on curvature at a vertex counts as concentrated there:
// charts that surround it flatten badly unless they are cut open up to it. Spikes of scan noise
// have more; a cone whose normals lean by 20 degrees has this one.
inline constexpr double kSharpDefect = 0.4;

// Returns by how much the angles around the vertex where h starts fall short of a full turn
// (negative: exceed it), in radians in [-pi, pi], modulo whole turns. Returns 0 at the mesh's
// boundary.
double angle_defect(const Topology& topology, std::uint32_t h);

// Finds tips such as the apexes of cones and the corners of boxes. Returns half-edges, each
// starting at a vertex with an angle defect, in pieces where nearly all other vertices have none.
// Linear in the number of triangles; a curved piece is given up after a few vertices.
std::vector<std::uint32_t> find_tips(const Topology& topology);

// Whether all vertices of these triangles but a few tips have no angle defect. The triangles are a
// piece.
bool developable(const Topology& topology, std::span<const std::uint32_t> triangles);

// Divides the cells that surround a tip in two. What unrolls has tips on its border only.
void divide_at_tips(const Topology& topology, const std::vector<std::uint32_t>& tips, Cells& cells);

}  // namespace atlas
