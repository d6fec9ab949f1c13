// Internal: finds where a border comes close to itself in uv, between places that are far apart on
// the surface.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "libatlas/param/mesh/halfedges.h"

namespace atlas::param {

// Texels mix places less than two texels apart. Along the banks of a cut, and around a corner of
// the border, these are the same place on the surface or adjacent ones. Here only places count that
// are farther from each other on the surface than kFar times the clearance.
class NearParts {
 public:
  static constexpr double kFar = 3;

  // A place on the border that is too close to another one.
  struct Place {
    std::uint32_t half_edge;
    double along;     // position on it, 0 to 1
    double length;    // length of border that the place represents
    double short_by;  // how much is missing to the clearance
    glm::dvec2 away;  // unit vector away from the other place
  };

  // `clearance` is in uv units, > 0. The mesh and its half-edges must outlive the object.
  NearParts(const LocalMesh& mesh, const BorderView& edges, double clearance,
            std::span<const Vec2d> uvs);

  // Returns the places in the order of the border, which must not cross itself. O(n log n).
  std::span<const Place> find(std::span<const Vec2d> uvs);

 private:
  // A part of the border, at most half the clearance long.
  struct Piece {
    std::uint32_t half_edge;
    double begin, end;  // range on it, 0 to 1
    glm::dvec3 point;   // its midpoint on the surface
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
  std::vector<glm::dvec2> middles_;  // one per piece
  std::vector<std::uint64_t> keys_;  // one per piece: the key of its cell
  std::vector<Cell> cells_;          // sorted
  std::vector<Place> places_;
};

}  // namespace atlas::param
