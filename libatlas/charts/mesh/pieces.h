// Internal: cuts pieces out of a mesh as a small mesh of their own, so that the memory a step needs
// does not grow with the rest of the mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/mesh/piece_list.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

struct PieceMesh {
  // The mesh of these pieces alone. Pieces are numbered from 0 in the order given; the triangles of
  // a piece keep their order. Each vertex belongs to one piece. Defects are not counted, and
  // source_vertex holds vertices of the whole topology.
  Topology topology;
  std::vector<std::uint32_t> triangles;  // one per triangle: its index in the whole
};

class PieceCutter {
 public:
  explicit PieceCutter(const Topology& whole);

  std::uint32_t piece_count() const { return whole_.component_count; }
  std::size_t triangle_count(std::uint32_t piece) const {
    return pieces_.first[piece + 1] - pieces_.first[piece];
  }

  // Returns the mesh of these pieces, in this order. Linear in their number of triangles.
  PieceMesh cut(std::span<const std::uint32_t> pieces);

 private:
  void add_piece(std::uint32_t piece, PieceMesh& out);
  void add_corners(std::uint32_t first_triangle, std::uint32_t first_vertex, PieceMesh& out);

  const Topology& whole_;
  PieceList pieces_;
  std::vector<std::uint32_t> place_;   // one per triangle of the whole: its index in its mesh
  std::vector<std::uint32_t> vertex_;  // one per vertex of the whole: its index in the last mesh
};

}  // namespace atlas
