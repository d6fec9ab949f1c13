// Turning a chart for the packer.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "libatlas/core/vec.h"

namespace atlas {

struct Orientation {
  double cosine = 1, sine = 0;  // the rotation that was applied, before the shift
  Vec2d size;                   // width >= height of the box afterwards, its corner at (0, 0)
};

// Rotates and shifts uvs in place so that their minimum-area bounding rectangle (rotating calipers
// on the convex hull; Freeman and Shapira 1975) is axis-aligned with its long side along u and its
// corner at (0, 0). No reflection, no scaling. Of equal rectangles the one of the hull's first edge
// (hull in counter-clockwise order from its lowest point) is taken. O(n log n).
// border_edges: those around a chart that covers nothing beyond them, as pairs of indices into uvs
// that begin at each corner of the border; or empty, for any points. If one direction (modulo 90
// degrees) carries at least a fifth of their length within half a degree, and the box along it is
// at most straight_slack larger than the smallest one, that direction wins: straight borders lie
// along texels.
Orientation orient_for_packing(std::span<Vec2d> uvs,
                               std::span<const std::array<std::uint32_t, 2>> border_edges = {},
                               double straight_slack = 0.02);

}  // namespace atlas
