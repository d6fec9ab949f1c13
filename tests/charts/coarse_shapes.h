// Topologies and coarse meshes of generated shapes.
#pragma once

#include <gtest/gtest.h>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/mesh/topology.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {

inline Topology topology_of(const Shape& shape) {
  const Mesh mesh(shape);
  Result<Topology> topology = build_topology(mesh.view(), {}, {});
  EXPECT_TRUE(topology.ok());
  return std::move(*topology);
}

// Returns the coarse mesh of a shape with cells of forty triangles.
inline CoarseMesh coarse_of(const Shape& shape) {
  const Topology topology = topology_of(shape);
  CellOptions options;
  options.triangles_per_cell = 40;
  options.mesh_triangles = 100000;
  Cells cells = grow_cells({topology, plan_cells(topology, options)}, options, {});
  return build_coarse(topology, 40, cells);
}

}  // namespace atlas::test
