// Internal: what double arithmetic leaves of a coordinate that is 0.
#pragma once

#include <cmath>

namespace atlas {

// x, or 0 where it is below 2^-40 of `size`, the extent of what it is a coordinate of, or -0: a
// right angle's turn leaves 1e-16 of it where 0 was meant, and equal points differ. Four of 120 CAD
// files have such cracks along planes through their origin.
inline float drop_rounding(double x, double size) {
  return std::abs(x) <= 0x1p-40 * size ? 0.0f : static_cast<float>(x);
}

}  // namespace atlas
