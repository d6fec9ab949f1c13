#include "libatlas/exporters/visitor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kWidthMetres = 0.25, kHeightMetres = 1.6, kStepMetres = 0.75, kSpeedMetres = 1.5;
constexpr double kOutsideShare = 1.0 / 50;  // width per distance to the box
constexpr double kInsideShare = 1.0 / 2;    // width per distance to the nearest triangle
// A viewpoint on a surface leaves no room at all: it is taken to be so much of the box's diagonal
// away from it.
constexpr double kLeastRoom = 1e-3;

struct Triangle {
  glm::dvec3 a, b, c;
};

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0;
  return glm::distance(p, a + t * along);
}

double distance_to(const glm::dvec3& p, const Triangle& t) {
  const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
  const double square = glm::dot(normal, normal);
  const auto left_of = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
  };
  if (square > 0 && left_of(t.a, t.b) && left_of(t.b, t.c) && left_of(t.c, t.a))
    return std::abs(glm::dot(p - t.a, normal)) / std::sqrt(square);
  return std::min({distance_to_segment(p, t.a, t.b), distance_to_segment(p, t.b, t.c),
                   distance_to_segment(p, t.c, t.a)});
}

// Returns how far below `p` the triangle's point straight below is; infinite if there is none.
double drop_to(const glm::dvec3& p, const Triangle& t, const glm::dvec3& up) {
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

// What surrounds the viewpoint.
struct Surroundings {
  Bounds<glm::dvec3> box;
  double nearest = std::numeric_limits<double>::infinity();  // triangle
  double floor = std::numeric_limits<double>::infinity();    // straight below
  double farthest = 0;                                       // corner
};

Surroundings surroundings_of(const World& world) {
  const glm::dvec3 eye = to_glm(world.viewpoint.position);
  const glm::dvec3 up = world.up == Up::z ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  Surroundings result;
  for (const Page& page : world.pages) {
    for (std::size_t k = 0; k < page.indices.size(); k += 3) {
      const auto corner = [&](std::size_t i) { return to_dvec(world.positions[page.indices[i]]); };
      const Triangle t{corner(k), corner(k + 1), corner(k + 2)};
      for (const glm::dvec3& p : {t.a, t.b, t.c}) {
        result.box.add(p);
        result.farthest = std::max(result.farthest, glm::distance(eye, p));
      }
      result.nearest = std::min(result.nearest, distance_to(eye, t));
      result.floor = std::min(result.floor, drop_to(eye, t, up));
    }
  }
  return result;
}

// Returns a person of this width.
Visitor scaled(double width) {
  const double scale = width / kWidthMetres;
  return {width, scale * kHeightMetres, scale * kStepMetres, scale * kSpeedMetres};
}

}  // namespace

Visitor visitor_of(const World& world) {
  const glm::dvec3 eye = to_glm(world.viewpoint.position);
  const Surroundings around = surroundings_of(world);
  const Visitor person = scaled(std::clamp(kWidthMetres / world.metres_per_unit, 1e-200, 1e200));
  if (!std::isfinite(around.nearest)) return person;  // a world without triangles
  const double least = kLeastRoom * glm::length(around.box.size());
  const double outside = glm::distance(eye, glm::clamp(eye, around.box.low, around.box.high));
  if (outside > 0) {
    Visitor visitor = scaled(kOutsideShare * std::max(outside, least));
    visitor.outside = true;
    visitor.farthest = around.farthest;
    return visitor;
  }
  const double room = std::max(around.nearest, least);
  Visitor visitor = scaled(std::min(person.width, kInsideShare * room));
  if (std::isfinite(around.floor)) {
    const double scale = std::min(1.0, std::max(around.floor, room) / person.height);
    visitor = {visitor.width, scale * person.height, scale * person.step, scale * person.speed};
  }
  visitor.farthest = around.farthest;
  return visitor;
}

}  // namespace atlas
