// A part whose caps are fans of needles around hubs.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/support/shapes.h"

namespace atlas::test {

inline Vec3f around_axis(double radius, double turn, double height) {
  const double angle = 2 * std::numbers::pi * turn;
  return {static_cast<float>(radius * std::cos(angle)),
          static_cast<float>(radius * std::sin(angle)), static_cast<float>(height)};
}

// A wheel with rectangular teeth, capped by fans around its two hubs. Of each twelve indices, the
// first six are those of a wall, and the next three those of the lower cap.
inline Shape toothed_wheel(std::uint32_t teeth, double depth = 0.01) {
  Shape shape;
  shape.name = "wheel_" + std::to_string(teeth);
  const std::uint32_t n = 4 * teeth;
  for (const double height : {0.0, 0.1}) {
    for (std::uint32_t i = 0; i < teeth; ++i) {
      shape.positions.push_back(around_axis(1, i / double(teeth), height));
      shape.positions.push_back(around_axis(1, (i + 0.5) / teeth, height));
      shape.positions.push_back(around_axis(1 + depth, (i + 0.5) / teeth, height));
      shape.positions.push_back(around_axis(1 + depth, (i + 1.0) / teeth, height));
    }
  }
  shape.positions.push_back({0, 0, 0});
  shape.positions.push_back({0, 0, 0.1f});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    for (const std::uint32_t v :
         {i, j, n + j, i, n + j, n + i, 2 * n, j, i, 2 * n + 1, n + i, n + j})
      shape.indices.push_back(v);
  }
  return shape;
}

}  // namespace atlas::test
