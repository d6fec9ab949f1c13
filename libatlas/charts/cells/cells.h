// Internal: micro-cells, the small compact regions that charts are assembled from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/cells/cell_plan.h"
#include "libatlas/charts/cells/regions.h"
#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

struct Cells {
  std::vector<std::uint32_t> of_triangle;  // one per triangle; kNoIndex if degenerate
  std::uint32_t count = 0;
};

struct CellInput {
  const Topology& topology;
  const CellPlan& plan;
  // If not null, each cell lies within one of these regions or within one part between them, and
  // each of these gets at least one cell, beyond the plan's numbers.
  const Regions* regions = nullptr;
  // One per piece: whether it gets no cells. Empty: all pieces get cells.
  std::span<const std::uint8_t> left_out = {};

  bool walled(std::uint32_t t, std::uint32_t u) const { return regions && regions->part(t, u); }
};

// Grows cells from well-spaced seeds. The distance from seed s to a triangle with normal n is path
// length times (1 + 8 (1 - n·n_s)), so cells stop at creases. Every cell is connected and lies in
// one piece, and none consists of triangles without area alone. Seeds are chosen on a graph of
// grains, patches of some ten triangles, by farthest-point sampling (in large pieces after seeds
// that are merely a few grains apart) and two recentring steps (the alternation of Cohen-Steiner et
// al. 2004). One pass over the triangles then grows the cells, and pull_teeth() (rims.h) smooths
// their borders. Cells are numbered by their seeds' place in the mesh. O(n log n) with a small
// heap.
Cells grow_cells(const CellInput& input, const CellOptions& options, const Context& context);

// Divides cells until the normals of each lie within half-angle `cone` (radians) of one direction.
// Cells that were connected stay so.
void split_by_cone(const Topology& topology, double cone, Cells& cells);

// Normals that represent all normals of a cell: any cone of less than a right angle that contains
// them contains all. They are the corners of the cell's convex hull on the sphere, that is, of the
// hull of its image in the tangent plane.
struct ExtremeNormals {
  std::vector<std::uint32_t> first;  // one per cell, and the end
  std::vector<Vec3f> normals;
  std::span<const Vec3f> of(std::uint32_t k) const {
    return {normals.data() + first[k], first[k + 1] - first[k]};
  }
};
ExtremeNormals extreme_normals(const Topology& topology, const Cells& cells);

}  // namespace atlas
