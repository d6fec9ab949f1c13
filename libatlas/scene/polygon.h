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
// n - 2 triangles. What is an ear is decided exactly in the projection: a simple outline that is
// not flat there gives triangles of its own orientation, however thin. False: concave with more
// than 2^20 corners, cut as a fan.
bool triangulate(std::span<const Vec3d> corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace atlas
