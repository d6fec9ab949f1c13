// Internal: how far a point is from a triangle in space.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas {

struct Triangle3 {
  glm::dvec3 a, b, c;
};

inline double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0;
  return glm::distance(p, a + t * along);
}

inline double distance_to(const glm::dvec3& p, const Triangle3& t) {
  const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
  const double square = glm::dot(normal, normal);
  const auto left_of = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
  };
  if (square > 0 && left_of(t.a, t.b) && left_of(t.b, t.c) && left_of(t.c, t.a))
    return std::abs(glm::dot(p - t.a, normal)) / std::sqrt(square);
  return std::min({distance_to_segment(p, t.a, t.b), distance_to_segment(p, t.b, t.c),
                   distance_to_segment(p, t.c, t.a)});
}

}  // namespace atlas
