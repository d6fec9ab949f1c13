// Random directions for property tests, and the algebra of vectors for their oracles.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "libatlas/core/vec.h"

namespace atlas::test {

inline constexpr double kDegree = std::numbers::pi / 180;

// Returns a vector whose direction is uniform on the sphere. Its length is about two.
inline Vec3d random_direction(std::mt19937& rng) {
  std::normal_distribution<double> n;
  const double x = n(rng), y = n(rng), z = n(rng);
  return {x, y, z};
}

inline double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline Vec3d scaled(const Vec3d& v, double factor) {
  return {v.x * factor, v.y * factor, v.z * factor};
}

inline Vec3d unit(const Vec3d& v) {
  return scaled(v, 1 / std::hypot(v.x, v.y, v.z));
}

}  // namespace atlas::test
