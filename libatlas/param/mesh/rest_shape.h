// Internal: the rest shape of a triangle, which is the triangle laid flat, as a flattening should
// map it, and the map from there to uv. Include this from .cpp files only.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/local_mesh.h"

namespace atlas::param {

// Corners are at (0, 0), (length, 0) and (foot, altitude). The base is the longest edge, so the
// foot is on it, altitude <= length, and nothing below divides by the short side of a sliver.
struct RestShape {
  std::array<std::uint32_t, 3> v;  // the triangle's vertices, rotated so that the base comes first
  std::uint8_t base = 0;           // the corner where the base begins
  double length = 0, foot = 0, altitude = 0;
  double area() const { return 0.5 * length * altitude; }
};

inline RestShape rest_shape(const LocalMesh& mesh, std::size_t t) {
  const auto& tri = mesh.triangles[t];
  const std::array<glm::dvec3, 3> p = {to_glm(mesh.positions[tri[0]]),
                                       to_glm(mesh.positions[tri[1]]),
                                       to_glm(mesh.positions[tri[2]])};
  const std::array<glm::dvec3, 3> e = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const std::array<double, 3> squared = {glm::dot(e[0], e[0]), glm::dot(e[1], e[1]),
                                         glm::dot(e[2], e[2])};
  int k = 0;
  if (squared[1] > squared[0]) k = 1;
  if (squared[2] > squared[k]) k = 2;
  const int k1 = k == 2 ? 0 : k + 1, k2 = k == 0 ? 2 : k - 1;
  RestShape s;
  s.v = {tri[k], tri[k1], tri[k2]};
  s.base = static_cast<std::uint8_t>(k);
  const double density = mesh.density.empty() ? 1.0 : mesh.density[t];
  const double length = std::sqrt(squared[k]);
  if (!(length > 0)) return s;
  const double inverse = 1 / length;
  s.length = length * density;
  s.foot = -glm::dot(e[k], e[k2]) * inverse * density;
  s.altitude = glm::length(glm::cross(e[k], e[k2])) * inverse * density;
  return s;
}

// The 2x2 matrix of the map from the rest shape to uv. Its columns are the images of the axes.
struct Jacobian {
  glm::dvec2 x, y;
  double det() const { return x.x * y.y - x.y * y.x; }
};

// Singular values, large >= |small|; small has the determinant's sign.
struct SingularValues {
  double large, small;
};

inline double largest_singular_value(const Jacobian& j) {
  const double e = 0.5 * (j.x.x + j.y.y), f = 0.5 * (j.x.x - j.y.y);
  const double g = 0.5 * (j.x.y + j.y.x), h = 0.5 * (j.x.y - j.y.x);
  return std::sqrt(e * e + h * h) + std::sqrt(f * f + g * g);
}

inline SingularValues singular_values(const Jacobian& j) {
  const double large = largest_singular_value(j);
  return {large,
          large > 0 ? j.det() / large : 0};  // the quotient keeps digits that a difference loses
}

// Returns (cosine, sine) of the rotation nearest to j in the Frobenius norm; (1, 0) if there is
// none.
inline glm::dvec2 nearest_rotation(const Jacobian& j) {
  const double c = j.x.x + j.y.y, s = j.x.y - j.y.x;
  const double norm = std::sqrt(c * c + s * s);
  if (!(norm > 0)) return {1, 0};
  return {c / norm, s / norm};
}

inline double cross(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
}

}  // namespace atlas::param
