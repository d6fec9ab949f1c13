// Internal: where a flat ring can be cut open.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

struct BandCrossing {
  std::uint32_t outer, inner;  // of `uvs`
  double length;
};

// Two ways across the band between two closed borders, lists of `uvs`, on opposite sides of the
// inner one's middle and as short together as eight directions tell; none if the band is not seen
// from there all around. O(n m) in the corners near a direction.
std::vector<BandCrossing> cross_band(std::span<const Vec2d> uvs,
                                     std::span<const std::uint32_t> outer,
                                     std::span<const std::uint32_t> inner);

}  // namespace atlas
