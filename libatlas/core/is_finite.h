// Internal: vectors that are numbers.
#pragma once

#include <cmath>

namespace atlas {

// Returns whether all coordinates of a vector of two or three are finite (Vec2f, glm::dvec3, ...).
template <class Vector>
bool is_finite(const Vector& v) {
  const bool flat = std::isfinite(v.x) && std::isfinite(v.y);
  if constexpr (requires { v.z; })
    return flat && std::isfinite(v.z);
  else
    return flat;
}

}  // namespace atlas
