// Internal: where a border comes near itself in uv, between places that are far apart on the
// surface.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "libatlas/param/halfedges.h"

namespace atlas::param {

// Texels mix what lies less than two of them apart. Along the banks of a cut, and around a corner
// of the border, that is the same place of the surface or one beside it; here only what is farther
// from each other on the surface than kFar times the clearance counts.
class NearParts {
 public:
  static constexpr double kFar = 3;

  // A place on the border that is too near to another one.
  struct Place {
    std::uint32_t half_edge;
    double along;     // where on it, 0 to 1
    double length;    // of border that the place stands for
    double short_by;  // of the clearance
    glm::dvec2 away;  // unit vector away from the other place
  };

  // `clearance` in units of uv, > 0. What is passed must outlive it.
  NearParts(const LocalMesh& mesh, const HalfEdges& half_edges, const HalfEdges::Border& border,
            double clearance, std::span<const Vec2d> uvs);

  // In the order of the border; the border must not cross itself. O(n log n).
  std::span<const Place> find(std::span<const Vec2d> uvs);

 private:
  // The border in pieces of at most half the clearance.
  struct Piece {
    std::uint32_t half_edge;
    double begin, end;  // on it, 0 to 1
    glm::dvec3 point;   // of its middle, on the surface
    double density;
  };
  struct Cell {
    std::uint64_t key;
    std::uint32_t piece;
    bool operator<(const Cell& other) const {
      return key != other.key ? key < other.key : piece < other.piece;
    }
  };

  glm::dvec2 at(std::uint32_t half_edge, double along, std::span<const Vec2d> uvs) const;
  glm::dvec2 outward(std::uint32_t half_edge, std::span<const Vec2d> uvs) const;
  bool far(const Piece& a, const Piece& b) const;
  void sort_into_cells(std::span<const Vec2d> uvs);
  void measure(std::uint32_t piece, std::span<const Vec2d> uvs);

  const HalfEdges& half_edges_;
  double clearance_, cell_;
  std::vector<Piece> pieces_;
  std::vector<glm::dvec2> middles_;  // 1 a piece
  std::vector<std::uint64_t> keys_;  // likewise: of its cell
  std::vector<Cell> cells_;          // sorted
  std::vector<Place> places_;
};

}  // namespace atlas::param
