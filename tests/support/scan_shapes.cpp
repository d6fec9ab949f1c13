// Round shapes as scanners produce them: evenly triangulated at any resolution, with noise along
// the normals.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>

#include "libatlas/core/glm_bridge.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

Shape geodesic_sphere(int n, double radius) {
  const Shape solid = icosphere(0);
  Shape shape;
  shape.name = "geodesic_sphere";
  std::map<std::array<std::uint32_t, 4>, std::uint32_t> known;  // points on corners and edges
  for (std::size_t f = 0; f < solid.indices.size(); f += 3) {
    const std::uint32_t* v = &solid.indices[f];
    // Returns the point with weights n - i - j, i, j. Points on a corner or an edge are shared.
    const auto at = [&](int i, int j) {
      const std::array<std::pair<std::uint32_t, int>, 3> weights{
          {{v[0], n - i - j}, {v[1], i}, {v[2], j}}};
      std::map<std::uint32_t, int> used;
      glm::dvec3 sum(0);
      for (const auto& [corner, weight] : weights) {
        if (weight > 0) used[corner] = weight;
      }
      for (const auto& [corner, weight] : used) {
        sum += double(weight) * to_dvec(solid.positions[corner]);
      }
      const Vec3f point = from_glm(glm::vec3(radius * glm::normalize(sum)));
      const auto fresh = std::uint32_t(shape.positions.size());
      if (used.size() < 3) {
        const std::array<std::uint32_t, 4> key{
            used.begin()->first, std::uint32_t(used.begin()->second), used.rbegin()->first,
            std::uint32_t(used.rbegin()->second)};
        const auto [place, is_new] = known.emplace(key, fresh);
        if (!is_new) return place->second;
      }
      shape.positions.push_back(point);
      return fresh;
    };
    std::vector<std::uint32_t> row, next;
    for (int i = 0; i <= n; ++i) row.push_back(at(i, 0));
    for (int j = 0; j < n; ++j, row = std::move(next)) {
      next.clear();
      for (int i = 0; i + j < n; ++i) next.push_back(at(i, j + 1));
      for (int i = 0; i + j < n; ++i) {
        for (const std::uint32_t x : {row[i], row[i + 1], next[i]}) shape.indices.push_back(x);
        if (i + j + 1 == n) continue;
        for (const std::uint32_t x : {row[i + 1], next[i + 1], next[i]}) shape.indices.push_back(x);
      }
    }
  }
  return shape;
}

Shape noisy_along_normals(Shape shape, double sigma, std::uint64_t seed) {
  std::vector<glm::dvec3> normal(shape.positions.size(), glm::dvec3(0));
  double length = 0;
  for (std::size_t i = 0; i < shape.indices.size(); i += 3) {
    const std::uint32_t* v = &shape.indices[i];
    const glm::dvec3 a = to_dvec(shape.positions[v[0]]), b = to_dvec(shape.positions[v[1]]),
                     c = to_dvec(shape.positions[v[2]]);
    for (int k = 0; k < 3; ++k) normal[v[k]] += glm::cross(b - a, c - a);
    length += glm::distance(a, b) + glm::distance(b, c) + glm::distance(c, a);
  }
  const double deviation = sigma * length / double(shape.indices.size());
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
  for (std::size_t v = 0; v < normal.size(); ++v) {
    // Uses the Box-Muller transform, because the standard library's distribution differs between
    // systems.
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    const double gauss = radius * std::cos(2 * kPi * uniform());
    const double size = glm::length(normal[v]);
    if (!(size > 0)) continue;
    shape.positions[v] =
        from_glm(glm::vec3(to_dvec(shape.positions[v]) + normal[v] * (deviation * gauss / size)));
  }
  return shape;
}

}  // namespace atlas::test
