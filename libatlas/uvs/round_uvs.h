// Internal: rounds uvs (fractions of a page) to floats so that no triangle is turned over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Rounds uvs (0..1) to floats. Rounding would turn over or close slivers thinner than some 10^-7 of
// the page, and specks, which are clusters of triangles smaller than 10^-12 of the page. Such
// triangles are opened: their corners move by the few last places of a float that this takes, and
// so do the corners of triangles that this closes in turn. The corners of stacks of slivers that
// lean on each other move by up to half a thousandth of the page, mostly along the slivers. The
// triangles stay open if the shortest decimals of these floats are read as doubles, or if the
// floats are multiplied by a page's size in single precision.
// `corners` are three per triangle, counter-clockwise in `exact`. Triangles that name a uv twice
// are points or lines, and stay so. `farthest` (> 0, a share of the page) limits how far a corner
// moves along either axis. On baked pages, it should be a texel, which is what their gutters
// tolerate. Returns how many triangles could not be opened.
std::size_t round_uvs(std::span<const Vec2d> exact, std::span<const std::uint32_t> corners,
                      std::vector<Vec2f>& rounded, double farthest = 1);

}  // namespace atlas
