// Internal: tests which triangles of single-precision uvs programs may find turned over or without
// area.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <span>

#include "libatlas/core/glm_bridge.h"

namespace atlas {

constexpr double kUvStep = 0x1p-24;  // step between floats just below 1
// How far a uv may be off for programs that read it. The shortest decimals of a float, read as a
// double, are off by up to half a step. Floats that are multiplied by a page's size are off by as
// much again.
constexpr double kUvSlack = kUvStep;
constexpr double kLeastUvArea = 1.1e-12;  // share of the page; less counts as no area

// Returns whether the triangle of three uvs is turned over, or could be if they were off by
// kUvSlack, or has less than kLeastUvArea. A triangle with two equal uvs does not count, because
// points and lines are meant to be so.
inline bool is_thin(std::span<const std::uint32_t, 3> c, std::span<const Vec2f> uvs) {
  if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return false;
  const glm::dvec2 p = to_dvec(uvs[c[0]]), u = to_dvec(uvs[c[1]]) - p, v = to_dvec(uvs[c[2]]) - p;
  const glm::dvec2 sides = glm::abs(u) + glm::abs(v) + glm::abs(v - u);
  const double twice = u.x * v.y - u.y * v.x;
  return twice <= std::max(kUvSlack * (sides.x + sides.y), 2 * kLeastUvArea);
}

// Returns twice the area from which on rounding leaves the triangle with sides u and v open.
// Rounding moves each corner by at most half a step along each axis, and changes twice the area by
// that times the length of the opposite side.
inline double open_area(glm::dvec2 u, glm::dvec2 v) {
  const glm::dvec2 sides = glm::abs(u) + glm::abs(v) + glm::abs(v - u);
  return std::max((kUvSlack + 0.51 * kUvStep) * (sides.x + sides.y), 3 * kLeastUvArea);
}

inline Vec2f rounded_uv(glm::dvec2 uv) {
  const glm::vec2 p = glm::clamp(glm::vec2(uv), 0.0f, 1.0f);
  return {p.x, p.y};
}

}  // namespace atlas
