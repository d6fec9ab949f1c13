#include <algorithm>
#include <cmath>
#include <span>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/geometry/tangents.h"
#include "libatlas/charts/mesh/piece_list.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/hull.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

// A chart's cone is measured again at the end, with different rounding. The margin (radians) keeps
// cells clear of the limit.
constexpr double kMargin = 1e-5;

// Wider cones are not projected to the tangent plane, where their normals would lie too far out.
constexpr double kHullCone = radians(80);

struct ProjectedNormal : Vec2d {
  Vec3f normal;
};

class ConeSplitter {
 public:
  ConeSplitter(const Topology& topology, double cone, Cells& cells)
      : topology_(topology), least_(portable::cos(std::max(0.0, cone - kMargin))), cells_(cells) {}

  // First separates the connected parts whose normals lie around the mean normal. What is left
  // becomes patches, each grown around the normal of its first triangle. The first part keeps the
  // cell's number.
  void divide(std::uint32_t k, std::span<const std::uint32_t> triangles) {
    glm::dvec3 mean(0);
    for (const std::uint32_t t : triangles) {
      mean += double(topology_.areas[t]) * to_dvec(topology_.normals[t]);
      cells_.of_triangle[t] = kPending;
    }
    const double length = glm::length(mean);
    if (length > 0) mean /= length;
    bool named = false;
    for (const bool around_mean : {true, false}) {
      for (const std::uint32_t t : triangles) {
        if (cells_.of_triangle[t] != kPending) continue;
        const glm::dvec3 axis = around_mean ? mean : to_dvec(topology_.normals[t]);
        if (around_mean && glm::dot(mean, to_dvec(topology_.normals[t])) < least_) continue;
        grow(t, named ? cells_.count++ : k, axis);
        named = true;
      }
    }
  }

 private:
  void grow(std::uint32_t seed, std::uint32_t name, const glm::dvec3& axis) {
    queue_.assign(1, seed);
    cells_.of_triangle[seed] = name;
    while (!queue_.empty()) {
      const std::uint32_t t = queue_.back();
      queue_.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || cells_.of_triangle[o / 3] != kPending) continue;
        if (glm::dot(axis, to_dvec(topology_.normals[o / 3])) < least_) continue;
        cells_.of_triangle[o / 3] = name;
        queue_.push_back(o / 3);
      }
    }
  }

  static constexpr std::uint32_t kPending = kNoIndex - 1;

  const Topology& topology_;
  double least_;
  Cells& cells_;
  std::vector<std::uint32_t> queue_;
};

}  // namespace

void split_by_cone(const Topology& topology, double cone, Cells& cells) {
  const TriangleLists lists(cells.of_triangle, cells.count);
  ConeSplitter splitter(topology, cone, cells);
  for (std::uint32_t k = 0; k < lists.count(); ++k) {
    if (lists.of(k).empty()) continue;
    if (normal_cone(topology.normals, lists.of(k)).angle > cone - kMargin) {
      splitter.divide(k, lists.of(k));
    }
  }
}

ExtremeNormals extreme_normals(const Topology& topology, const Cells& cells) {
  const TriangleLists lists(cells.of_triangle, cells.count);
  ExtremeNormals result;
  std::vector<ProjectedNormal> points, hull;
  for (std::uint32_t k = 0; k < cells.count; ++k) {
    result.first.push_back(static_cast<std::uint32_t>(result.normals.size()));
    if (lists.of(k).empty()) continue;
    const NormalCone cone = normal_cone(topology.normals, lists.of(k));
    const glm::dvec3 axis = to_dvec(cone.axis);
    const Tangents plane(axis);
    points.clear();
    for (const std::uint32_t t : lists.of(k)) {
      const glm::dvec3 n = to_dvec(topology.normals[t]);
      const double height = cone.angle < kHullCone ? glm::dot(n, axis) : 1;
      const glm::dvec2 p = plane.of(n) / height;
      points.push_back({{p.x, p.y}, topology.normals[t]});
    }
    // Stable: different normals may come to lie at one place.
    std::stable_sort(points.begin(), points.end(),
                     [](const ProjectedNormal& a, const ProjectedNormal& b) {
                       return a.x != b.x ? a.x < b.x : a.y < b.y;
                     });
    if (cone.angle < kHullCone && points.size() > 1) {
      sorted_hull(points, hull);
      points.swap(hull);
    }
    for (const ProjectedNormal& p : points) result.normals.push_back(p.normal);
  }
  result.first.push_back(static_cast<std::uint32_t>(result.normals.size()));
  return result;
}

}  // namespace atlas
