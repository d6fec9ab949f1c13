#include "benchmarks/light_leak/shadow_edge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/luma.h"

namespace atlas::bench {
namespace {

double luma_of(Vec3f e) {
  return luma<double>(e.x, e.y, e.z);
}

// Returns the area-weighted mean over an object's triangles.
double mean_luma(const Scene& scene, const std::vector<std::uint32_t>& triangles) {
  double sum = 0, areas = 0;
  for (const std::uint32_t t : triangles) {
    glm::dvec3 p[3];
    double light = 0;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = scene.indices[3 * t + k];
      p[k] = to_dvec(scene.positions[v]);
      light += luma_of(scene.illumination[v]) / 3;
    }
    const double area = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
    sum += area * light;
    areas += area;
  }
  return areas > 0 ? sum / areas : 0;
}

// Returns the crossings on a triangle's three edges (at most three) of which one end has at least
// the given light.
std::vector<glm::dvec3> crossings(const Scene& scene, std::uint32_t triangle, double light,
                                  const ShadowEdgeOptions& options) {
  std::vector<glm::dvec3> found;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t a = scene.indices[3 * triangle + k];
    const std::uint32_t b = scene.indices[3 * triangle + (k + 1) % 3];
    const double la = luma_of(scene.illumination[a]), lb = luma_of(scene.illumination[b]);
    if (std::max(la, lb) < light) continue;
    const glm::dvec3 pa = to_dvec(scene.positions[a]), pb = to_dvec(scene.positions[b]);
    if (std::abs(la - lb) <= options.drop * std::max(la, lb)) continue;
    if (glm::distance(pa, pb) * scene.metres_per_unit > options.length) continue;
    found.push_back(0.5 * (pa + pb));  // linear between both ends, so the mean value lies half-way
  }
  return found;
}

}  // namespace

ShadowEdge find_shadow_edge(const Scene& scene, const ShadowEdgeOptions& options) {
  ShadowEdge edge;
  const double spacing = options.spacing / scene.metres_per_unit;
  for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
    if (scene.object_names[scene.triangle_object[t]] != options.object) continue;
    edge.triangles.push_back(t);
  }
  const double light = mean_luma(scene, edge.triangles);
  for (const std::uint32_t t : edge.triangles) {
    const std::vector<glm::dvec3> ends = crossings(scene, t, light, options);
    if (ends.size() == 1) edge.points.push_back(from_glm(glm::vec3(ends[0])));
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      for (std::size_t j = i + 1; j < ends.size(); ++j) {
        const double length = glm::distance(ends[i], ends[j]);
        const int steps = std::max(1, int(std::ceil(length / spacing)));
        for (int s = 0; s <= steps; ++s)
          edge.points.push_back(from_glm(glm::vec3(glm::mix(ends[i], ends[j], double(s) / steps))));
        edge.length += length * scene.metres_per_unit;
      }
    }
  }
  return edge;
}

NearPoints::NearPoints(const std::vector<Vec3f>& points, double radius)
    : points_(points), radius_(radius) {
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3f& p = points[i];
    cells_.push_back(
        {key(std::int64_t(std::floor(p.x / radius)), std::int64_t(std::floor(p.y / radius)),
             std::int64_t(std::floor(p.z / radius))),
         i});
  }
  std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
    return a.key != b.key ? a.key < b.key : a.point < b.point;
  });
}

// Uses 21 bits per axis. Cells whose keys would collide are so far apart that they are never in the
// same scene of up to a million radii.
std::uint64_t NearPoints::key(std::int64_t x, std::int64_t y, std::int64_t z) const {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  return (std::uint64_t(x) & kMask) << 42 | (std::uint64_t(y) & kMask) << 21 |
         (std::uint64_t(z) & kMask);
}

double NearPoints::distance(Vec3d p) const {
  const auto x = std::int64_t(std::floor(p.x / radius_)),
             y = std::int64_t(std::floor(p.y / radius_)),
             z = std::int64_t(std::floor(p.z / radius_));
  double best = radius_;
  bool found = false;
  for (int i = 0; i < 27; ++i) {
    const std::uint64_t k = key(x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1);
    auto at = std::lower_bound(cells_.begin(), cells_.end(), k,
                               [](const Cell& c, std::uint64_t v) { return c.key < v; });
    for (; at != cells_.end() && at->key == k; ++at) {
      const double d = glm::distance(to_glm(p), to_dvec(points_[at->point]));
      if (d > best) continue;
      best = d;
      found = true;
    }
  }
  return found ? best : std::numeric_limits<double>::infinity();
}

}  // namespace atlas::bench
