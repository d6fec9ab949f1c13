#include "libatlas/exporters/viewing/visitor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/triangle_distance.h"

namespace atlas {
namespace {

constexpr double kWidthMetres = 0.25, kHeightMetres = 1.6, kStepMetres = 0.75, kSpeedMetres = 1.5;
constexpr double kOutsideShare = 1.0 / 50;  // width per distance to the box
constexpr double kInsideShare = 1.0 / 2;    // width per distance to the nearest triangle
// A viewpoint on a surface leaves no room at all: it is taken to be so much of the box's diagonal
// away from it.
constexpr double kLeastRoom = 1e-3;

// Returns how far below `p` the triangle's point straight below is; infinite if there is none.
double drop_to(const glm::dvec3& p, const Triangle3& t, const glm::dvec3& up) {
  const glm::dvec3 corners[3] = {t.a - p, t.b - p, t.c - p};
  double weights[3], sum = 0, height = 0;
  for (int i = 0; i < 3; ++i) {
    const auto [u, v] = std::pair(corners[(i + 1) % 3], corners[(i + 2) % 3]);
    weights[i] = glm::dot(glm::cross(u, v), up);
    sum += weights[i];
    height += weights[i] * glm::dot(corners[i], up);
  }
  const bool below = (weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0) ||
                     (weights[0] <= 0 && weights[1] <= 0 && weights[2] <= 0);
  if (!below || sum == 0 || !(height / sum < 0)) return std::numeric_limits<double>::infinity();
  return -height / sum;
}

// Calls `visit` with each triangle.
template <class Visit>
void for_triangles(const World& world, const Visit& visit) {
  for (const Page& page : world.pages) {
    const auto corner = [&](std::size_t i) { return to_dvec(world.positions[page.indices[i]]); };
    for (std::size_t k = 0; k < page.indices.size(); k += 3)
      visit(Triangle3{corner(k), corner(k + 1), corner(k + 2)});
  }
}

// The free space around a viewpoint. Infinite without triangles.
struct Room {
  double nearest = std::numeric_limits<double>::infinity();  // triangle
  double floor = std::numeric_limits<double>::infinity();    // straight below
};

Room room_of(const World& world) {
  const glm::dvec3 eye = to_glm(world.viewpoint.position);
  const glm::dvec3 up = world.up == Up::z ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  Room room;
  for_triangles(world, [&](const Triangle3& t) {
    room.nearest = std::min(room.nearest, distance_to(eye, t));
    room.floor = std::min(room.floor, drop_to(eye, t, up));
  });
  return room;
}

// Returns a person of this width.
Visitor scaled(double width) {
  const double scale = width / kWidthMetres;
  return {width, scale * kHeightMetres, scale * kStepMetres, scale * kSpeedMetres};
}

}  // namespace

Visitor visitor_of(const World& world) {
  const glm::dvec3 eye = to_glm(world.viewpoint.position);
  Bounds<glm::dvec3> box;
  double farthest = 0;
  for_triangles(world, [&](const Triangle3& t) {
    for (const glm::dvec3& p : {t.a, t.b, t.c}) {
      box.add(p);
      farthest = std::max(farthest, glm::distance(eye, p));
    }
  });
  const Visitor person = scaled(std::clamp(kWidthMetres / world.metres_per_unit, 1e-200, 1e200));
  if (box.low.x > box.high.x) return person;  // a world without triangles
  const double least = kLeastRoom * glm::length(box.size());
  const double outside = glm::distance(eye, glm::clamp(eye, box.low, box.high));
  Visitor visitor;
  if (outside > 0) {
    visitor = scaled(kOutsideShare * std::max(outside, least));
    visitor.outside = true;
  } else {
    const Room room = room_of(world);
    const double nearest = std::max(room.nearest, least);
    visitor = scaled(std::min(person.width, kInsideShare * nearest));
    if (std::isfinite(room.floor)) {
      const double scale = std::min(1.0, std::max(room.floor, nearest) / person.height);
      visitor = {visitor.width, scale * person.height, scale * person.step, scale * person.speed};
    }
  }
  visitor.farthest = farthest;
  return visitor;
}

}  // namespace atlas
