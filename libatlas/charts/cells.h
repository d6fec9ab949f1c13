// Internal: micro-cells, the small compact regions that charts are assembled from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/cone.h"
#include "libatlas/charts/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

struct CellOptions {
  // A piece of n triangles gets about n / this cells, more in meshes that would have fewer than
  // cells_of_small_mesh in all, whose charts would have few to choose from, and where it has
  // handles,
  std::uint32_t triangles_per_cell = 80;
  std::uint32_t cells_of_small_mesh = 146;
  std::uint32_t max_cells_per_piece = 600;  // but not more than this, however fine it is.
  // Cells are added, beyond those numbers, until no grain leans more than this to its cell's seed.
  double max_lean_degrees = 55;
  std::size_t mesh_triangles = 0;  // of the mesh that the topology is a part of; 0: it is all
  double first_seed = 0;           // where the first one lies, in [0, 1): other cells, as good
};

struct Cells {
  std::vector<std::uint32_t> of_triangle;  // 1 a triangle; kNoIndex if degenerate
  std::uint32_t count = 0;
};

// Grows cells from well-spaced seeds; the distance from seed s to a triangle with normal n is path
// length times (1 + 8 (1 - n·n_s)), so cells stop at creases. Every cell is connected and lies in
// one piece. Seeds come from farthest-point sampling, in large pieces of what is a few grains apart
// already, and two recentring steps (Cohen-Steiner et al. 2004 for the alternation) on a graph of
// grains of some ten triangles, then one pass over the triangles, whose teeth are pulled in the end
// (rims.h). Cells are numbered by their seeds' place in the mesh. O(n log n) with a small heap.
Cells grow_cells(const Topology& topology, const CellOptions& options, const Context& context);

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
