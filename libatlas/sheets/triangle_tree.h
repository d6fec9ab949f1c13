// Internal: finds the triangles near a point by a tree of boxes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "libatlas/core/bounds.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Triangles sorted along a curve that keeps neighbours together, under a tree of bounding boxes in
// which every node has four children.
class TriangleTree {
 public:
  // `triangles` are numbers of triangles whose corners are `indices`, three each, into `positions`.
  // The tree holds copies of what it needs.
  TriangleTree(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
               std::vector<std::uint32_t> triangles);

  // Calls found(triangle) for triangles until one of the calls returns true, and returns whether
  // one did. Every triangle whose box is within `reach` of the point is among them, and some others
  // may be.
  template <class Found>
  bool any_near(const Vec3f& point, float reach, const Found& found) const {
    return !levels_.empty() && any_below({levels_.size() - 1, 0}, {point, reach}, found);
  }

 private:
  static constexpr std::size_t kChildren = 4;

  using Box = Bounds<glm::vec3>;
  struct Node {
    std::size_t level, index;
  };
  struct Ball {
    Vec3f centre;
    float radius;
  };

  static bool touches(const Box& box, const Ball& ball) {
    const auto [p, r] = ball;
    return box.low.x - r <= p.x && p.x <= box.high.x + r && box.low.y - r <= p.y &&
           p.y <= box.high.y + r && box.low.z - r <= p.z && p.z <= box.high.z + r;
  }

  template <class Found>
  bool any_below(const Node& node, const Ball& ball, const Found& found) const {
    if (!touches(levels_[node.level][node.index], ball)) return false;
    const std::size_t begin = kChildren * node.index;
    const std::size_t all = node.level == 0 ? triangles_.size() : levels_[node.level - 1].size();
    const std::size_t end = std::min(begin + kChildren, all);
    for (std::size_t i = begin; i < end; ++i) {
      if (node.level == 0 ? found(triangles_[i]) : any_below({node.level - 1, i}, ball, found))
        return true;
    }
    return false;
  }

  std::vector<std::uint32_t> triangles_;
  std::vector<std::vector<Box>> levels_;  // level 0 has the boxes of four triangles each
};

}  // namespace atlas
