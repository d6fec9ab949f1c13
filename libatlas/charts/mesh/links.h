// Internal: which half-edges of a mesh belong together.
#pragma once

#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Fills Topology::opposite and fan_links, and counts the defects of edges; points, corners, normals
// and flags are given. Linear in the number of triangles but for fans around one edge.
void link_half_edges(const MeshView& mesh, const TopologyOptions& options, Topology& topology);

}  // namespace atlas
