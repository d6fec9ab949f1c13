// Internal: opens stacks of slivers that lean on each other, all slivers of a stack together.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Triangles with their uvs before rounding.
struct ExactTriangles {
  std::span<const std::uint32_t> corners;  // three per triangle, into exact
  const Buckets& corners_at;               // the corners at each uv
  std::span<const glm::dvec2> exact;       // one per uv
};

// What opening took, for tests.
struct StackWork {
  std::size_t patterns = 0;  // analyses of which entries of a matrix are not zero
  std::size_t solves = 0;
};

// Opens stacks of thin triangles that cannot be opened one by one: their uvs, or those at their far
// ends, would have to move along the slivers by much more than these lack in height. All uvs of a
// stack move at once, so that each triangle there gets a height that rounding leaves open, and none
// is closed on the way. This minimises an energy: a barrier for each triangle that lacks height (Li
// et al. 2020, "Incremental potential contact", eq. 6), and a tether to the exact uvs. The tether
// is loosened until the heights are reached, at most to some thousand steps between floats, or to
// `farthest` (a share of the page). A stack that needs more stays as it is. A move is kept only if
// it leaves fewer thin triangles (thin_uvs.h). Triangles that are turned over in their exact uvs
// stay as they are.
StackWork open_stacks(const ExactTriangles& triangles, double farthest, std::vector<Vec2f>& uvs);

}  // namespace atlas
