// Internal: the coarse mesh of micro-cells that merging works on. Every cell is a fan of triangles
// from its centre to the corners of its rim; neighbouring cells share arcs of their rims.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/geometry/moments.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/vec.h"

namespace atlas {

// A stretch of rim between two corners, seen by one cell or two.
struct CoarseArc {
  // The corner slots (below) where each side's walk starts; the arc ends at the slot after it.
  // Side 1 runs the other way; kNoIndex where the mesh ends.
  std::array<std::uint32_t, 2> slot{kNoIndex, kNoIndex};
  std::array<std::uint32_t, 2> cell{kNoIndex, kNoIndex};
  double length = 0;  // along the mesh's edges
  double crease = 0;  // the part of it that is sharper than the crease angle
};

struct CoarseCell {
  std::uint32_t first_slot = 0, slot_count = 0;  // its rim, counter-clockwise
  Vec3d centre, normal;                          // area-weighted means; normal is a unit vector
  double area = 0;
  Moments moments{};     // sum of area n n^T
  Vec3d normal_sum;      // sum of area n
  bool unrolls = false;  // bent, but without stretching: see unroll.h
  Vec2d flat_centre;     // then, with CoarseMesh::flat_slot: its triangles laid flat
};

struct CoarseMesh {
  std::vector<CoarseCell> cells;
  std::vector<Vec3d> slot_position;           // 1 a slot
  std::vector<std::uint32_t> slot_arc;        // the arc that starts there
  std::vector<std::uint32_t> slot_half_edge;  // of the topology: the first of that arc, cell's side
  std::vector<std::uint8_t> slot_tip;         // 1 a slot: it lies in a tip (tips.h); empty: none
  std::vector<Vec2d> flat_slot;               // 1 a slot, where its cell unrolls; empty: none does
  std::vector<CoarseArc> arcs;
  std::vector<std::uint32_t> rim_half_edges;  // of the topology, both sides
  std::vector<std::uint32_t> rim_arcs;        // 1 a rim half-edge: the arc it belongs to
  std::uint32_t next_slot(std::uint32_t slot, const CoarseCell& cell) const {
    return slot + 1 == cell.first_slot + cell.slot_count ? cell.first_slot : slot + 1;
  }
};

// Cells whose border is not one loop (a ring round a handle, an island's surroundings) are divided
// first, so `cells` may grow; small holes of the mesh inside a cell are passed over. Linear in the
// number of triangles.
CoarseMesh build_coarse(const Topology& topology, double crease_degrees, Cells& cells);

}  // namespace atlas
