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

// A part of a rim between two corners, which belongs to one cell or two.
struct CoarseArc {
  // For each side, the corner slot (below) where its walk starts; the arc ends at the slot after
  // it. Side 1 runs in the opposite direction; it is kNoIndex at the mesh's boundary.
  std::array<std::uint32_t, 2> slot{kNoIndex, kNoIndex};
  std::array<std::uint32_t, 2> cell{kNoIndex, kNoIndex};
  double length = 0;  // along the mesh's edges
  double weight = 0;  // what it costs as a seam (border_weight)
};

struct CoarseCell {
  std::uint32_t first_slot = 0, slot_count = 0;  // its rim, counter-clockwise
  Vec3d centre, normal;                          // area-weighted means; normal has unit length
  double area = 0;
  Moments moments{};     // sum of area n n^T
  Vec3d normal_sum;      // sum of area n
  bool unrolls = false;  // bent, but can be laid flat without stretch, see unroll.h
  Vec2d flat_centre;     // if it unrolls: its centre, in the plane of flat_slot
};

struct CoarseMesh {
  std::vector<CoarseCell> cells;
  std::vector<Vec3d> slot_position;     // one per slot
  std::vector<std::uint32_t> slot_arc;  // the arc that starts at the slot
  // The first half-edge of that arc on the cell's side, in the topology.
  std::vector<std::uint32_t> slot_half_edge;
  // One per slot: it lies on a tip (tips.h) or, unless the mesh is noisy, has kSharpDefect.
  std::vector<std::uint8_t> slot_sharp;
  // One per slot: its place when its cell is laid flat, if that unrolls. Empty: no cell unrolls.
  std::vector<Vec2d> flat_slot;
  std::vector<CoarseArc> arcs;
  std::vector<std::uint32_t> rim_half_edges;  // half-edges of the topology on rims, both sides
  std::vector<std::uint32_t> rim_arcs;        // one per rim half-edge: its arc
  std::uint32_t next_slot(std::uint32_t slot, const CoarseCell& cell) const {
    return slot + 1 == cell.first_slot + cell.slot_count ? cell.first_slot : slot + 1;
  }
};

// Builds the coarse mesh, in time linear in the number of triangles. Cells whose border is not one
// loop (a ring around a handle, or a cell around another) are divided first, so `cells` may grow.
// Small holes of the mesh within a cell are ignored.
CoarseMesh build_coarse(const Topology& topology, double crease_degrees, Cells& cells);

// Returns by how much the area of a cell's fan differs from the cell's own area, as a share of the
// latter; 0 for a cell without area. Fans of compact cells err by some 7 %, for outlines are
// jagged.
double fan_error(const CoarseMesh& mesh, const CoarseCell& cell);

}  // namespace atlas
