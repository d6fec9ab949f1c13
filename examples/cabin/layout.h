// The cabin's dimensions, in metres. x points aft, z up from the floor, y across from the middle.
// Passengers look towards -x, where the door and the galley are.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "examples/cabin/cabin_mesh.h"
#include "libatlas/core/context.h"

namespace cabin {

constexpr double kLength = 6.2;       // between the bulkheads
constexpr double kRadius = 1.55;      // of the lining
constexpr double kAxisHeight = 0.78;  // of the fuselage's axis above the floor
constexpr int kBays = 12;             // window bays along each side
constexpr double kBay = kLength / kBays;
constexpr double kWindowHeight = 1.0;  // height of the windows' centres along the wall
constexpr glm::dvec2 kWindowHalf{0.135, 0.185};
constexpr double kRevealDepth = 0.07, kRevealScale = 0.86;
constexpr int kRows = 5;
constexpr double kFirstRow = 2.15, kRowPitch = 0.82;
constexpr double kBinStart = 1.95;

// Converts wall coordinates to space. `x` is along the cabin, `height` is the arc length along the
// wall from the widest line of the fuselage, and `depth` is the distance in front of the wall.
// `side` is +1 or -1, the sign of y.
inline glm::dvec3 wall_point(int side, double x, double height, double depth) {
  const double angle = height / kRadius, r = kRadius - depth;
  return {x, side * r * std::cos(angle), kAxisHeight + r * std::sin(angle)};
}
// Returns the arc length along the wall for a height above the floor.
inline double wall_height(double z) {
  return kRadius * std::asin((z - kAxisHeight) / kRadius);
}
// Returns half the cabin's width at a height above the floor.
inline double half_width(double z) {
  return std::sqrt(std::max(0.0, kRadius * kRadius - (z - kAxisHeight) * (z - kAxisHeight)));
}

// Returns whether a bay has a window. The door and the galley take the place of two windows on each
// side.
inline bool has_window(int bay) {
  return bay <= 1 || bay >= 4;
}
// Returns the share of a window that its blind covers.
inline double blind_share(int side, int bay) {
  if (side < 0) return bay == 6 ? 0.35 : bay == 9 ? 0.6 : 0;
  return bay == 5 ? 0.5 : bay == 8 ? 0.25 : bay == 11 ? 1.0 : 0;
}
// Returns a point of a window's rim: maps (qx, qy) on the border of [-1, 1]² to a superellipse.
inline glm::dvec2 window_rim(double qx, double qy) {
  const double n = std::pow(qx * qx * qx * qx + qy * qy * qy * qy, 0.25);
  return {kWindowHalf.x * qx / n, kWindowHalf.y * qy / n};
}

struct AreaLight {
  std::vector<glm::vec3> corners;  // convex and planar, clockwise seen from the lit side
  glm::vec3 exitance;              // lux
  glm::vec3 normal;                // unit, towards the lit side
};

// Each function adds one part to the mesh.
void add_shell(Builder& builder);
void add_ceiling(Builder& builder);
void add_bins(Builder& builder);
void add_seats(Builder& builder);
void add_door(Builder& builder);
void add_galley(Builder& builder);

// A strip of light along x that extends across from `from` to `to`, in `pieces` of equal length.
struct Strip {
  double x0, x1;
  glm::dvec2 from, to;  // (y, z); it shines in the direction x cross (to - from)
  int pieces;
  std::string material;
};
std::vector<Strip> light_strips();

std::vector<SurfaceMaterial> cabin_materials();

// Returns the whole cabin, welded, with at most `triangles` triangles or with as few as its round
// shapes need. If those are more than `limit`, small parts stay angular.
Mesh build_cabin(std::size_t triangles, std::size_t limit, const atlas::Context& context = {});

}  // namespace cabin
