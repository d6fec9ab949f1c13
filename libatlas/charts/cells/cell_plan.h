// Internal: how many cells each piece of a mesh gets.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/mesh/piece_list.h"
#include "libatlas/charts/mesh/topology.h"

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

struct CellPlan {
  PieceList pieces;
  std::vector<std::uint32_t> cells;   // 1 a piece: how many it gets
  std::vector<std::uint8_t> pierced;  // 1 a piece: it has handles, or holes
};

// Of pieces without handles and holes, up to max_cells_per_piece.
std::uint32_t triangles_per_cell(const Topology& topology, const CellOptions& options);

CellPlan plan_cells(const Topology& topology, const CellOptions& options);

}  // namespace atlas
