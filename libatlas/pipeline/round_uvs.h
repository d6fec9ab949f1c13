// Internal: page fractions as floats, no triangle turned over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Rounds uvs (0..1) to floats. Slivers that this would turn over or close, those thinner than some
// 10^-7 of the page, and specks of less than 10^-12 of it are opened: corners move by the few last
// places of a float that it takes, and so on with what that closes in its turn; those of stacks of
// slivers that lean on each other by up to half a thousandth of the page, mostly along them. They
// stay open where the shortest decimals of these floats are read as doubles, or are multiplied in
// floats by a page's size. `corners`: 3 a triangle, counter-clockwise in `exact`; those that name a
// uv twice are points or lines and stay so. `farthest` (> 0, of the page): no corner is moved by
// more along either axis, but for those of specks, by up to 10^-4 more; of baked pages a texel is
// what their gutters forgive. Returns how many triangles could not be opened.
std::size_t round_uvs(std::span<const Vec2d> exact, std::span<const std::uint32_t> corners,
                      std::vector<Vec2f>& rounded, double farthest = 1);

}  // namespace atlas
