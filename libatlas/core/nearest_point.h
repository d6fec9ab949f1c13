// Internal: NearestPoint, a k-d tree of points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/sort_total.h"

namespace atlas {

// Finds the nearest of some points, which must outlive it, in logarithmic time, however uneven they
// lie. Source: Bentley 1975.
class NearestPoint {
 public:
  explicit NearestPoint(std::span<const Vec3f> points) : points_(points), ids_(points.size()) {
    for (std::uint32_t i = 0; i < ids_.size(); ++i) ids_[i] = i;
    build(0, ids_.size(), 0);
  }

  struct Found {
    std::uint32_t id = kNoIndex;
    double squared = std::numeric_limits<double>::infinity();
  };
  // Returns the nearest point within the distance whose square is given; of equally near ones, that
  // of the lowest number.
  Found find(Vec3f p, double squared) const {
    Found found{kNoIndex, squared};
    search(0, ids_.size(), 0, to_dvec(p), found);
    return found;
  }

 private:
  void build(std::size_t begin, std::size_t end, int axis) {
    if (end - begin < 2) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return ids_.begin() + std::ptrdiff_t(i); };
    nth_total(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(to_glm(points_[a])[axis], a) < std::pair(to_glm(points_[b])[axis], b);
    });
    build(begin, middle, (axis + 1) % 3);
    build(middle + 1, end, (axis + 1) % 3);
  }

  void search(std::size_t begin, std::size_t end, int axis, glm::dvec3 p, Found& found) const {
    if (begin >= end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const std::uint32_t id = ids_[middle];
    const glm::dvec3 d = p - to_dvec(points_[id]);
    const double squared = glm::dot(d, d);
    if (squared < found.squared || (squared == found.squared && id < found.id))
      found = {id, squared};
    const int next = (axis + 1) % 3;
    const bool below = d[axis] < 0;
    const auto side = [&](bool low) {
      if (low)
        search(begin, middle, next, p, found);
      else
        search(middle + 1, end, next, p, found);
    };
    side(below);
    if (d[axis] * d[axis] <= found.squared) side(!below);
  }

  std::span<const Vec3f> points_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace atlas
