// Internal: micro-cells, the small compact regions that charts are assembled from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/cells/cell_plan.h"
#include "libatlas/charts/cells/faces.h"
#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

struct Cells {
  std::vector<std::uint32_t> of_triangle;  // 1 a triangle; kNoIndex if degenerate
  std::uint32_t count = 0;
};

struct CellInput {
  const Topology& topology;
  const CellPlan& plan;
  // Each cell lies in one face, or in what is between them, of which each region has a cell at
  // least, beyond the plan's numbers; null: cells go where they like.
  const Faces* faces = nullptr;
  std::span<const std::uint8_t> left_out = {};  // 1 a piece: it gets no cells; empty: all do

  bool walled(std::uint32_t t, std::uint32_t u) const { return faces && faces->part(t, u); }
};

// Grows cells from well-spaced seeds; the distance from seed s to a triangle with normal n is path
// length times (1 + 8 (1 - n·n_s)), so cells stop at creases. Every cell is connected and lies in
// one piece. Seeds come from farthest-point sampling, in large pieces of what is a few grains apart
// already, and two recentring steps (Cohen-Steiner et al. 2004 for the alternation) on a graph of
// grains of some ten triangles, then one pass over the triangles, whose teeth are pulled in the end
// (rims.h). Cells are numbered by their seeds' place in the mesh. O(n log n) with a small heap.
Cells grow_cells(const CellInput& input, const CellOptions& options, const Context& context);

// Divides cells until the normals of each lie within half-angle `cone` (radians) of one direction.
// Connected cells stay connected.
void split_by_cone(const Topology& topology, double cone, Cells& cells);

// Normals that stand for those of a cell: a cone of less than a right angle that holds them holds
// all (they span the cell's convex hull on the sphere, the border of its image in the tangent
// plane).
struct ExtremeNormals {
  std::vector<std::uint32_t> first;  // 1 a cell and the end
  std::vector<Vec3f> normals;
  std::span<const Vec3f> of(std::uint32_t k) const {
    return {normals.data() + first[k], first[k + 1] - first[k]};
  }
};
ExtremeNormals extreme_normals(const Topology& topology, const Cells& cells);

}  // namespace atlas
