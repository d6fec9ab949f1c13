// Internal: two directions perpendicular to a third one.
#pragma once

#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas {

// u and v form a right-handed frame with the unit vector `normal`: cross(u, v) = normal.
struct Tangents {
  glm::dvec3 u, v;

  explicit Tangents(const glm::dvec3& normal)
      : u(glm::normalize(glm::cross(
            normal, std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)))),
        v(glm::cross(normal, u)) {}

  glm::dvec2 of(const glm::dvec3& d) const { return {glm::dot(d, u), glm::dot(d, v)}; }
};

}  // namespace atlas
