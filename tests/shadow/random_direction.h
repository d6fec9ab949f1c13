// Directions of all kinds for property tests.
#pragma once

#include <random>

#include "libatlas/core/vec.h"

namespace atlas::test {

// Returns a vector whose direction is uniform on the sphere. Its length is about two.
inline Vec3d random_direction(std::mt19937& rng) {
  std::normal_distribution<double> n;
  const double x = n(rng), y = n(rng), z = n(rng);
  return {x, y, z};
}

}  // namespace atlas::test
