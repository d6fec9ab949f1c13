// Internal: numbers of files as floats.
#pragma once

#include <algorithm>
#include <limits>

namespace atlas {

// The nearest float that is finite; text holds numbers beyond float. Not for NaN.
inline float finite_float(double number) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return float(std::clamp(number, -kMost, kMost));
}

}  // namespace atlas
