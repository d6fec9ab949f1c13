// Internal: pushes thin triangles open one at a time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/uvs/open_stacks.h"

namespace atlas {

// What pushing took, for tests.
struct PushWork {
  std::size_t pushes = 0;  // moves of a triangle's corners
  std::size_t looks = 0;   // heights measured to find what these moves have closed
};

// Pushes thin triangles open (thin_uvs.h), and in turn those that this closes, first come, first
// served (position-based dynamics, Müller et al. 2007). A corner moves in proportion to the length
// of the opposite edge, so the two near corners of a sliver are parted. Starts from the exact uvs,
// and moves none by more than some thousand steps between floats, nor by more than `farthest` from
// `home` (one per uv). What takes too many pushes stays as it is. The time does not grow with the
// square of the number of triangles at a uv, as only those are looked at again that may lack height
// after its way so far.
PushWork push_slivers(const ExactTriangles& triangles, std::span<const Vec2d> home, double farthest,
                      std::vector<Vec2f>& uvs);

}  // namespace atlas
