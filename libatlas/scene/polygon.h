// Internal: polygons in space as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Cuts a polygon of n >= 3 corners into n - 2 triangles of its corner numbers, in its orientation.
// Convex ones become a fan from corner 0, concave ones lose ears, in the projection along the
// polygon's largest normal component (Newell's normal). Degenerate or crossing outlines still give
// n - 2 triangles. Ears are found by exact predicates in the projection, so that a simple
// outline gives triangles of its own orientation there, however thin they are. False: concave with
// more than 2^20 corners, cut as a fan.
bool triangulate(std::span<const Vec3d> corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace atlas
