// Internal: which triangles of single-precision uvs readers may find turned over or without area.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <span>

#include "libatlas/core/glm_bridge.h"

namespace atlas {

constexpr double kUvStep = 0x1p-24;  // between floats just below one
// How far a uv may be off for readers: the shortest decimals of a float, read as a double, are off
// by half of that; floats multiplied by a page's size by as much again.
constexpr double kUvSlack = kUvStep;
constexpr double kLeastUvArea = 1.1e-12;  // of the page: less counts as nothing

// Whether the triangle of three uvs is turned over, or would be if they were off by kUvSlack. Not
// if two of them are the same: points and lines are meant to be so.
inline bool is_thin(std::span<const std::uint32_t, 3> c, std::span<const Vec2f> uvs) {
  if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return false;
  const glm::dvec2 p = to_dvec(uvs[c[0]]), u = to_dvec(uvs[c[1]]) - p, v = to_dvec(uvs[c[2]]) - p;
  const glm::dvec2 sides = glm::abs(u) + glm::abs(v) + glm::abs(v - u);
  const double twice = u.x * v.y - u.y * v.x;
  return twice <= std::max(kUvSlack * (sides.x + sides.y), 2 * kLeastUvArea);
}

// Twice the area from which on rounding leaves the triangle of sides u, v open: rounding moves each
// corner by half a step along each axis, and twice the area by that times the side across.
inline double open_area(glm::dvec2 u, glm::dvec2 v) {
  const glm::dvec2 sides = glm::abs(u) + glm::abs(v) + glm::abs(v - u);
  return std::max((kUvSlack + 0.51 * kUvStep) * (sides.x + sides.y), 3 * kLeastUvArea);
}

inline Vec2f rounded_uv(glm::dvec2 uv) {
  const glm::vec2 p = glm::clamp(glm::vec2(uv), 0.0f, 1.0f);
  return {p.x, p.y};
}

}  // namespace atlas
