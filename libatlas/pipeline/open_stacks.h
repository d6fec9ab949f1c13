// Internal: stacks of slivers that lean on each other, opened together.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Triangles by their uvs before these were rounded.
struct ExactTriangles {
  std::span<const std::uint32_t> corners;  // 3 a triangle, into exact
  const Buckets& corners_at;               // those of each uv
  std::span<const glm::dvec2> exact;       // 1 a uv
};

// Where slivers of a stack can only be opened by moving along them, or their far ends, by much more
// than they lack in height: all uvs of a stack move at once, so that each triangle there gets the
// height that rounding leaves open, and none is closed on the way. The energy is a barrier for each
// triangle that lacks height (Li et al. 2020, "Incremental potential contact", eq. 6), and a
// tether to the exact uvs that is loosened until the heights are reached, at most to some thousand
// steps between floats, or to `farthest` (of the page): a stack that needs more stays as it is.
// Only what leaves fewer thin triangles (thin_uvs.h) is kept. Triangles that are turned over in
// their exact uvs stay as they are.
void open_stacks(const ExactTriangles& triangles, double farthest, std::vector<Vec2f>& uvs);

}  // namespace atlas
