// Parts whose caps are fans of needles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

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

// A wheel with 128 low, rounded teeth and 30 716 triangles. The polygon between the teeth's roots
// is a fan of needles around one of its corners.
inline Shape low_toothed_wheel() {
  constexpr std::uint32_t kTeeth = 128, kFlank = 30, kTooth = 2 * kFlank, kRim = kTeeth * kTooth;
  Shape shape;
  shape.name = "low_toothed_wheel";
  for (const double height : {0.0, 0.15}) {
    for (std::uint32_t i = 0; i < kRim; ++i) {
      const std::uint32_t k = i % kTooth;
      const double rise = std::min(k, kTooth - 1 - k) / (kFlank - 1.0);
      const double half = 0.3 - 0.18 * rise * rise;
      const double turn = (i / kTooth + 0.5 + (k < kFlank ? -half : half)) / kTeeth;
      shape.positions.push_back(around_axis(1 + 0.014 * rise, turn, height));
    }
  }
  const auto both_caps = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t v : {a, c, b, kRim + a, kRim + b, kRim + c})
      shape.indices.push_back(v);
  };
  for (std::uint32_t root = 0; root < kRim; root += kTooth) {
    const std::uint32_t end = root + kTooth - 1;
    for (std::uint32_t k = 1; k + 1 < kTooth; ++k) both_caps(root, root + k, root + k + 1);
    if (root > 0) both_caps(0, root, end);
    if (root > 0 && root + kTooth < kRim) both_caps(0, end, root + kTooth);
  }
  both_caps(0, kTooth - 1, kTooth);
  for (std::uint32_t i = 0; i < kRim; ++i) {
    const std::uint32_t j = (i + 1) % kRim;
    for (const std::uint32_t v : {i, j, kRim + j, i, kRim + j, kRim + i})
      shape.indices.push_back(v);
  }
  return shape;
}

}  // namespace atlas::test
