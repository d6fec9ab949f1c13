#include "libatlas/texture/standing_walls.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace atlas {
namespace {

// An edge is looked at in so many places, in the middle of as many equal parts. Whatever only
// touches an end of it, as a wall across it does, is far from most of them.
constexpr int kPlaces = 5;

// The least reach, relative to the edge's length: positions are floats.
constexpr double kRounding = 1e-6;

std::vector<std::uint32_t> all_triangles(const Scene& scene) {
  std::vector<std::uint32_t> all(scene.triangle_count());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

}  // namespace

StandingWalls::StandingWalls(const Scene& scene, double reach)
    : scene_(scene), reach_(reach), tree_(scene.positions, scene.indices, all_triangles(scene)) {}

Triangle3 StandingWalls::triangle(std::uint32_t t) const {
  const auto corner = [&](std::size_t k) {
    return to_dvec(scene_.positions[scene_.indices[3 * std::size_t(t) + k]]);
  };
  return {corner(0), corner(1), corner(2)};
}

bool StandingWalls::along(const Edge& edge, double least_cosine) const {
  const double reach = std::max(reach_, kRounding * glm::distance(edge.from, edge.to));
  const auto stands_at = [&](const glm::dvec3& p) {
    return tree_.any_near(from_glm(glm::vec3(p)), float(reach), [&](std::uint32_t t) {
      const Triangle3 wall = triangle(t);
      const glm::dvec3 cross = glm::cross(wall.b - wall.a, wall.c - wall.a);
      const double twice = glm::length(cross);
      return twice > 0 && std::abs(glm::dot(cross, edge.normal)) <= least_cosine * twice &&
             distance_to(p, wall) <= reach;
    });
  };
  int there = 0;
  for (int i = 0; i < kPlaces; ++i)
    there += stands_at(glm::mix(edge.from, edge.to, (i + 0.5) / kPlaces));
  return 2 * there > kPlaces;
}

}  // namespace atlas
