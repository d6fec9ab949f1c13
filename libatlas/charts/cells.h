// Internal: micro-cells, the small compact regions that charts are assembled from.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/topology.h"
#include "libatlas/core/context.h"

namespace atlas {

struct CellOptions {
  std::uint32_t triangles_per_cell = 40;    // a piece of n triangles gets about n / this cells,
  std::uint32_t max_cells_per_piece = 600;  // but not more than this, however fine it is
  // Cells are added, beyond those numbers, until no grain leans more than this to its cell's seed.
  double max_lean_degrees = 55;
};

struct Cells {
  std::vector<std::uint32_t> of_triangle;  // 1 a triangle; kNoIndex if degenerate
  std::uint32_t count = 0;
};

// Grows cells from well-spaced seeds; the distance from seed s to a triangle with normal n is path
// length times (1 + 8 (1 - n·n_s)), so cells stop at creases. Every cell is connected and lies in
// one piece. Seeds come from farthest-point sampling and two recentring steps (Cohen-Steiner et al.
// 2004 for the alternation) on a graph of grains of some ten triangles, then one pass over the
// triangles. O(n log n) with a small heap.
Cells grow_cells(const Topology& topology, const CellOptions& options, const Context& context);

}  // namespace atlas
