// Internal: is_finite() for vectors.
#pragma once

#include <cmath>

namespace atlas {

// Returns whether all two or three coordinates of a vector (Vec2f, glm::dvec3, ...) are finite.
template <class Vector>
bool is_finite(const Vector& v) {
  const bool flat = std::isfinite(v.x) && std::isfinite(v.y);
  if constexpr (requires { v.z; })
    return flat && std::isfinite(v.z);
  else
    return flat;
}

}  // namespace atlas
