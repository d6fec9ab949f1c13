// Internal: the two halves of build_topology(), for callers that order the places in between.
#pragma once

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/charts/mesh/weld.h"

namespace atlas {

// Checks a mesh and welds its vertices. Errors: those of build_topology().
Result<WeldedVertices> weld_mesh(const MeshView& mesh);

// `mesh` has passed weld_mesh(), in this order or in another. Its positions are not used.
struct WeldedMesh {
  MeshView mesh;
  WeldedVertices vertices;
  std::vector<std::uint32_t> opposite;  // pair_links() of the places
};

// Error: cancelled.
Result<Topology> build_topology(WeldedMesh welded, const TopologyOptions& options,
                                const Context& context);

}  // namespace atlas
