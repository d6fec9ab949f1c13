// Internal: pieces of a mesh as a small mesh of their own, so that what a step needs for them does
// not grow with the rest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/mesh/piece_list.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

struct PieceMesh {
  // Of these pieces alone, numbered from 0 in their order; triangles of a piece keep theirs.
  // Vertices belong to one piece each. Without defects, and source_vertex names vertices of the
  // whole.
  Topology topology;
  std::vector<std::uint32_t> triangles;  // 1 a triangle: its name in the whole
};

class PieceCutter {
 public:
  explicit PieceCutter(const Topology& whole);

  std::uint32_t piece_count() const { return whole_.component_count; }
  std::size_t triangle_count(std::uint32_t piece) const {
    return pieces_.first[piece + 1] - pieces_.first[piece];
  }

  // These pieces, in this order. Linear in their triangles.
  PieceMesh cut(std::span<const std::uint32_t> pieces);

 private:
  void add_piece(std::uint32_t piece, PieceMesh& out);
  void add_corners(std::uint32_t first_triangle, std::uint32_t first_vertex, PieceMesh& out);

  const Topology& whole_;
  PieceList pieces_;
  std::vector<std::uint32_t> place_;   // 1 a triangle of the whole: its name in its mesh
  std::vector<std::uint32_t> vertex_;  // 1 a vertex of the whole: its name in the last piece
};

}  // namespace atlas
