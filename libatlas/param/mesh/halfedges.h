// Internal: finds the opposite of each half-edge of a triangle set, and walks along boundary loops.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/half_edge.h"
#include "libatlas/param/local_mesh.h"

namespace atlas::param {

// The half-edges of a triangle set, numbered as in core/half_edge.h.
class HalfEdges {
 public:
  // Takes the mesh's opposites, or finds them in O(n), even with vertices of high valence. Where
  // more than two triangles share an edge, pairs are made in order of id.
  void build(const LocalMesh& mesh);
  void build(std::span<const std::array<std::uint32_t, 3>> triangles, std::size_t vertices);

  // kNoIndex on the boundary.
  std::uint32_t opposite(std::uint32_t h) const { return opposite_[h]; }
  static std::uint32_t triangle(std::uint32_t h) { return h / 3; }
  std::uint32_t from(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return from(next_half_edge(h)); }
  const std::array<std::uint32_t, 3>& corners(std::uint32_t t) const { return triangles_[t]; }

  // Returns the boundary half-edge that follows h along its loop.
  std::uint32_t next_border(std::uint32_t h) const {
    h = next_half_edge(h);
    while (opposite_[h] != kNoIndex) h = next_half_edge(opposite_[h]);
    return h;
  }

  // Half-edges without an opposite, loop after loop. loop_start holds the index of each loop's
  // first one, and the total at the end.
  struct Border {
    std::vector<std::uint32_t> half_edges, loop_start;
  };
  void border(Border& out) const;

 private:
  std::uint32_t find_opposite(std::uint32_t h) const;

  std::span<const std::array<std::uint32_t, 3>> triangles_;
  std::span<const std::uint32_t> opposite_;
  std::vector<std::uint32_t> found_, first_, out_;
};

// Returns the edges without an opposite as pairs of vertices, in the order of the half-edges.
std::vector<std::array<std::uint32_t, 2>> border_edges(
    std::span<const std::array<std::uint32_t, 3>> triangles, std::size_t vertices);

// The half-edges of a mesh, and those of them that are its border.
struct BorderView {
  const HalfEdges& all;
  const HalfEdges::Border& border;
};

}  // namespace atlas::param
