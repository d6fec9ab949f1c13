// Turns a chart for the packer.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "libatlas/core/vec.h"

namespace atlas {

struct Orientation {
  double cosine = 1, sine = 0;  // the rotation that was applied, before the translation
  Vec2d size;                   // width >= height of the resulting box, whose corner is at (0, 0)
};

// Rotates and translates uvs in place so that their minimum-area bounding rectangle (rotating
// calipers on the convex hull; Freeman and Shapira 1975) is axis-aligned, with its long side along
// u and its corner at (0, 0). There is no reflection and no scaling. Among equal rectangles, that
// of the hull's first edge is taken (counter-clockwise from its lowest point). O(n log n).
// border_edges: the edges around a chart that covers nothing outside of them, as pairs of indices
// into uvs, one beginning at each corner of the border; or empty, for any points. If one direction
// (modulo 90 degrees) has at least a fifth of their length within half a degree, and the box along
// it is at most straight_slack larger than the smallest one, that direction is used, so that
// straight borders lie along texels.
Orientation orient_for_packing(std::span<Vec2d> uvs,
                               std::span<const std::array<std::uint32_t, 2>> border_edges = {},
                               double straight_slack = 0.02);

}  // namespace atlas
