// Internal: conversions between the plain vectors of the public headers and GLM's vectors, which do
// the algebra inside the library. Include it only from .cpp files and internal headers.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "libatlas/core/vec.h"

namespace atlas {

inline glm::vec2 to_glm(Vec2f v) {
  return {v.x, v.y};
}
inline glm::dvec2 to_glm(Vec2d v) {
  return {v.x, v.y};
}
inline glm::vec3 to_glm(Vec3f v) {
  return {v.x, v.y, v.z};
}
inline glm::dvec3 to_glm(Vec3d v) {
  return {v.x, v.y, v.z};
}
inline glm::dvec3 to_dvec(Vec3f v) {
  return {v.x, v.y, v.z};
}
inline glm::dvec2 to_dvec(Vec2f v) {
  return {v.x, v.y};
}
inline Vec2f from_glm(const glm::vec2& v) {
  return {v.x, v.y};
}
inline Vec2d from_glm(const glm::dvec2& v) {
  return {v.x, v.y};
}
inline Vec3f from_glm(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}
inline Vec3d from_glm(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

// Returns the direction of a vector, or `otherwise` if it has none. Computed in double: the squares
// of areas leave the range of floats for parts of some 10^-10 of a scene.
inline glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  const glm::dvec3 d(v);
  const double length = glm::length(d);
  return length > 0 ? glm::vec3(d / length) : otherwise;
}

}  // namespace atlas
