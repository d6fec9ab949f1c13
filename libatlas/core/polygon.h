// Polygons of a mesh and the triangles that they are cut into; the one way to cut them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Cuts a polygon of n >= 3 corners into n - 2 triangles of corner numbers, which keep its
// orientation. Convex polygons become a fan from corner 0, or are swept in linear time if corners
// that hang on straight sides (to within the rounding of floats) would give triangles of the fan no
// area. Concave ones are cut by ear clipping. Both are done in
// the projection along the largest component of the polygon's normal (Newell's normal). Degenerate
// or self-intersecting outlines also give n - 2 triangles. Ears are found with exact predicates in
// the projection, so a simple outline gives triangles of its own orientation there, however thin
// they are. Returns false for a concave polygon that is cut as a fan, since it has more than 2^20
// corners, or ears are so rare in it that finding them would take more than some 20 µs a corner;
// not if `limited` is false.
bool triangulate(std::span<const Vec3d> corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles, bool limited = true);

// The polygons of a mesh, and which of their corners its triangles have.
struct PolygonCorners {
  std::vector<std::uint32_t> first = {};      // one per polygon, and the end: its first corner
  std::vector<std::uint32_t> polygon = {};    // one per triangle
  std::vector<std::uint32_t> triangles = {};  // three per triangle: corners of the polygons

  std::size_t count() const { return first.empty() ? 0 : first.size() - 1; }
  // Adds a polygon of `corners` corners that is cut into these triangles of corner numbers.
  void add(std::size_t corners, std::span<const std::array<std::uint32_t, 3>> triangles);
};

// Returns the corner of the polygons at which the side of a polygon begins that half-edge h of the
// triangles is; kNoIndex for an edge inside a polygon.
std::uint32_t side_of(const PolygonCorners& polygons, std::uint32_t h);

// Returns whether a polygon names its vertices, which are given by their numbers, so often that it
// cannot be the outline of an area. Such an outline may come back to a vertex where it is joined to
// those of holes, but passes each of the at most 3 n edges between n vertices of a plane twice.
bool goes_round_and_round(std::span<const std::int64_t> vertices);

}  // namespace atlas
