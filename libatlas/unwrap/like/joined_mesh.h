// Internal: a mesh as triangles of places, with what lies across their edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/half_edge.h"
#include "libatlas/core/vec.h"

namespace atlas {

struct JoinedMesh {
  std::vector<Vec3f> points = {};           // one per place
  std::vector<std::uint32_t> objects = {};  // one per place, or empty
  std::vector<std::uint32_t> corners = {};  // three per triangle: the place of each
  // One per half-edge: the half-edge of the one other triangle that has this edge, or kNoIndex.
  std::vector<std::uint32_t> across = {};

  std::size_t triangle_count() const { return corners.size() / 3; }
};

// Vertices at one place, of one object, are one (charts/mesh/weld.h). O(n log n).
JoinedMesh join_triangles(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                          std::span<const std::uint32_t> objects);

// Returns the mean length of the edges of all triangles, 0 without any.
double mean_edge(const JoinedMesh& mesh);

}  // namespace atlas
