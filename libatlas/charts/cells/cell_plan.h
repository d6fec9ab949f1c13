// Internal: how many cells each piece of a mesh gets.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/mesh/piece_list.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

struct CellOptions {
  // A piece of n triangles gets about n / triangles_per_cell cells. It gets more where it has
  // handles or holes, and in a mesh that would have fewer than cells_of_small_mesh cells in all,
  // whose charts would have few to choose from.
  std::uint32_t triangles_per_cell = 80;
  std::uint32_t cells_of_small_mesh = 146;
  bool each_piece_alone = false;            // as if each piece were a mesh of its own
  std::uint32_t max_cells_per_piece = 600;  // upper limit, however fine a piece is
  // More cells are added, beyond the numbers above, until the normals of all grains lie within this
  // angle of that of their cell's seed. In pieces that unroll, max_cells_per_piece still holds.
  double max_lean_degrees = 55;
  std::size_t mesh_triangles = 0;  // of the whole mesh; 0: the topology's
  // Where the first seed lies in each piece, in [0, 1). Each value gives other cells, equally good.
  double first_seed = 0;
};

struct CellPlan {
  PieceList pieces;
  std::vector<std::uint32_t> cells;   // one per piece: its number of cells; 0: it is left out
  std::vector<std::uint8_t> pierced;  // one per piece: has handles, or holes
};

// Returns how many triangles a cell has in pieces without handles and holes that do not reach
// max_cells_per_piece.
std::uint32_t triangles_per_cell(const Topology& topology, const CellOptions& options);

CellPlan plan_cells(const Topology& topology, const CellOptions& options);

}  // namespace atlas
