// Internal: finds which half-edges of a mesh are opposite to each other.
#pragma once

#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Fills Topology::opposite, fan_links and cut_length, and counts the defects of edges. Points,
// corners, normals and flags must be filled, and opposite must have what pair_links() finds. Linear
// in the number of triangles, except for fans around one edge.
void link_half_edges(const MeshView& mesh, const TopologyOptions& options, Topology& topology);

}  // namespace atlas
