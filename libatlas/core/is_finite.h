// Internal: vectors that are numbers.
#pragma once

#include <cmath>

namespace atlas {

// Whether both or all three coordinates of a vector are: a Vec2f, a glm::dvec3, ...
template <class Vector>
bool is_finite(const Vector& v) {
  const bool flat = std::isfinite(v.x) && std::isfinite(v.y);
  if constexpr (requires { v.z; })
    return flat && std::isfinite(v.z);
  else
    return flat;
}

}  // namespace atlas
