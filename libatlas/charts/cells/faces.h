// Internal: the flat faces of a mesh, as CAD parts have them.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cell_plan.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Faces: connected triangles in one plane, with at least about a quarter of a cell's area.
struct Faces {
  std::vector<std::uint32_t> of_triangle;  // one per triangle: its face; kNoIndex: none
  std::vector<double> share;               // one per piece: the share of its area in faces

  // Whether the edge between these triangles bounds a face.
  bool part(std::uint32_t t, std::uint32_t u) const { return of_triangle[t] != of_triangle[u]; }
};

// Finds the faces of all pieces. It finds none in pieces of more than 20 000 triangles, nor where
// faces would divide a piece into more than three times as many regions as it has planned cells.
// Linear in the number of triangles.
Faces find_faces(const Topology& topology, const CellPlan& plan);

}  // namespace atlas
