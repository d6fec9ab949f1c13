// Internal: angles in degrees, as options give them, and in radians.
#pragma once

#include <cmath>
#include <numbers>

#include "libatlas/core/portable_math.h"

namespace atlas {

constexpr double radians(double angle) {
  return angle * std::numbers::pi / 180;
}

constexpr double degrees(double angle) {
  return angle * 180 / std::numbers::pi;
}

inline double cosine_of(double angle) {
  return portable::cos(radians(angle));
}

}  // namespace atlas
