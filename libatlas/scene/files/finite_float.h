// Internal: turns numbers of files into floats.
#pragma once

#include <algorithm>
#include <limits>

namespace atlas {

// Returns the nearest finite float, since text may hold numbers beyond the range of float. `number`
// must not be NaN.
inline float finite_float(double number) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return float(std::clamp(number, -kMost, kMost));
}

}  // namespace atlas
