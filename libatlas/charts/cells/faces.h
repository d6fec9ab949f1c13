// Internal: the flat faces of a mesh, as CAD parts have them.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cell_plan.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Connected triangles of one plane, about as large as a quarter of a cell at least.
struct Faces {
  std::vector<std::uint32_t> of_triangle;  // 1 a triangle: a name; kNoIndex: it belongs to none
  std::vector<double> share;               // 1 a piece: of its area

  // Whether an edge between these triangles bounds a face.
  bool part(std::uint32_t t, std::uint32_t u) const { return of_triangle[t] != of_triangle[u]; }
};

// None in pieces of more than 20 000 triangles, and in those that they would divide into three
// times as many regions as the plan has cells for them. Linear in the number of triangles.
Faces find_faces(const Topology& topology, const CellPlan& plan);

}  // namespace atlas
