// Internal: triangles so thin that their normals say nothing.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Says which triangles are so thin that rounding coordinates to floats decides their normals.
class RoundingLimit {
 public:
  // Of a topology with its points.
  explicit RoundingLimit(const Topology& topology);

  // `p` are the corners, `cross` the product of two edges, and `longest` the square of the longest
  // edge.
  bool blurs(const std::array<glm::dvec3, 3>& p, const glm::dvec3& cross, double longest) const {
    // Nearly all triangles end here.
    if (glm::dot(cross, cross) > most_ * most_ * longest) return false;
    return lies_within(p, cross, longest);
  }

 private:
  static bool lies_within(const std::array<glm::dvec3, 3>& p, const glm::dvec3& cross,
                          double longest);

  double most_ = 0;  // the farthest that rounding moves two corners apart
};

// Gives each of these triangles the normal of a neighbour that is not one of them, or has got a
// normal so, across the longest such edge. Those without area (Topology::kThin) that reach none
// within a hundred steps become Topology::kDegenerate, and others keep their own normals. Links
// must be filled. Linear.
void borrow_normals(Topology& topology, std::vector<std::uint32_t> thin);

}  // namespace atlas
