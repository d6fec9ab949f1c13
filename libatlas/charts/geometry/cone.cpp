#include "libatlas/charts/geometry/cone.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

struct Ball {
  glm::dvec3 centre{0};
  double radius2 = -1;
  bool holds(const glm::dvec3& p) const {
    const glm::dvec3 d = p - centre;
    return glm::dot(d, d) <= radius2 * (1 + 1e-12) + 1e-18;
  }
};

Ball ball(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 centre = 0.5 * (a + b), d = a - centre;
  return {centre, glm::dot(d, d)};
}

// The ball with a, b and c on a great circle.
Ball ball(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = b - a, v = c - a, w = glm::cross(u, v);
  const double w2 = glm::dot(w, w);
  if (!(w2 > 1e-30)) return {};
  const glm::dvec3 offset =
      (glm::dot(u, u) * glm::cross(v, w) + glm::dot(v, v) * glm::cross(w, u)) / (2 * w2);
  return {a + offset, glm::dot(offset, offset)};
}

// Returns the smallest ball around a few points on the unit sphere that lie within a half-space.
// Two or three of them determine it.
Ball smallest_ball(const std::vector<glm::dvec3>& points) {
  Ball best;
  best.radius2 = 4;
  const auto consider = [&](const Ball& candidate) {
    if (candidate.radius2 < 0 || candidate.radius2 >= best.radius2) return;
    for (const glm::dvec3& p : points) {
      if (!candidate.holds(p)) return;
    }
    best = candidate;
  };
  if (points.size() == 1) return {points[0], 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      consider(ball(points[i], points[j]));
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        consider(ball(points[i], points[j], points[k]));
      }
    }
  }
  return best;
}

// Returns the normal farthest from the axis, and the cosine between them. `normal(i)` is the i-th
// of `count`.
template <class Normal>
std::pair<glm::dvec3, double> farthest(std::size_t count, const Normal& normal,
                                       const glm::vec3& axis) {
  float least = 2;
  glm::vec3 worst(axis);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 n = to_glm(normal(i));
    const float cosine = glm::dot(n, axis);
    if (cosine < least && (n.x != 0 || n.y != 0 || n.z != 0)) {
      least = cosine;
      worst = n;
    }
  }
  if (least > 1.5f) return {glm::dvec3(axis), 1.0};
  return {glm::dvec3(worst), least};
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return 2 * portable::atan2(glm::length(a - b), glm::length(a + b));
}

template <class Normal>
NormalCone smallest_cone(std::size_t count, const Normal& normal) {
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i < count; ++i) sum += to_dvec(normal(i));
  const double length = glm::length(sum);
  glm::dvec3 axis = length > 0 ? sum / length : glm::dvec3(0, 0, 1);
  glm::dvec3 best_axis = axis;
  double best = 10;
  std::vector<glm::dvec3> support;
  for (int round = 0; round < 12; ++round) {
    const auto [worst, cosine] = farthest(count, normal, glm::vec3(axis));
    const double angle = angle_between(axis, worst);
    if (angle < best) {
      best = angle;
      best_axis = axis;
    }
    if (round == 0 && cosine <= 0) break;  // there may be no half-space that contains them all
    if (std::find(support.begin(), support.end(), worst) != support.end()) break;
    support.push_back(worst);
    const Ball enclosing = smallest_ball(support);
    const double distance = glm::length(enclosing.centre);
    if (!(distance > 1e-3)) break;
    axis = enclosing.centre / distance;
  }
  return {from_glm(glm::vec3(best_axis)), best};
}

}  // namespace

NormalCone normal_cone(std::span<const Vec3f> normals, std::span<const std::uint32_t> ids) {
  return smallest_cone(ids.size(), [&](std::size_t i) { return normals[ids[i]]; });
}

NormalCone part_of_cone(std::span<const Vec3f> normals, std::span<const std::uint32_t> ids,
                        const NormalCone& whole) {
  const NormalCone own = normal_cone(normals, ids);
  if (own.angle <= whole.angle) return own;
  const auto normal = [&](std::size_t i) { return normals[ids[i]]; };
  const glm::dvec3 axis = to_dvec(whole.axis);
  return {whole.axis, angle_between(axis, farthest(ids.size(), normal, to_glm(whole.axis)).first)};
}

NormalCone normal_cone(std::span<const Vec3f> normals) {
  return smallest_cone(normals.size(), [&](std::size_t i) { return normals[i]; });
}

}  // namespace atlas
