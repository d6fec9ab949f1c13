#include "libatlas/charts/mesh/thin.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace atlas {
namespace {

// Two corners are each rounded by half of this share of a coordinate.
constexpr double kFloatStep = 1.0 / (1 << 23);

// Gives thin triangles the normal of a neighbour that is not, the one across the longest such edge.
// A triangle without area that reaches none is taken out; others keep their own normal.
class NormalLender {
 public:
  NormalLender(Topology& topology, std::vector<std::uint32_t> thin)
      : topology_(topology), waiting_(std::move(thin)) {}

  void run() {
    std::vector<Vec3f> own;
    for (const std::uint32_t t : waiting_) {
      own.push_back(std::exchange(topology_.normals[t], Vec3f{}));
    }
    const std::vector<std::uint32_t> thin = waiting_;
    for (int row = 0; row < kMostRows && lend(); ++row) {
    }
    for (std::size_t i = 0; i < thin.size(); ++i) {
      if (!known(thin[i])) topology_.normals[thin[i]] = own[i];
    }
    for (const std::uint32_t t : waiting_) {
      if (topology_.thin(t)) take_out(t);
    }
  }

 private:
  bool known(std::uint32_t t) const { return topology_.normals[t] != Vec3f{}; }

  // How many thin triangles a normal goes through. Longer rows, with nothing else beside them, are
  // no part of any surface.
  static constexpr int kMostRows = 100;

  // Lends to the neighbours of triangles with a normal. Returns false if there was none.
  bool lend() {
    std::vector<std::pair<std::uint32_t, Vec3f>> found;
    for (const std::uint32_t t : waiting_) {
      const std::uint32_t h = lender(t);
      if (h == kNoIndex) continue;
      const std::uint32_t o = topology_.opposite[h];
      const Vec3f n = topology_.normals[o / 3];
      const bool turned = topology_.corner_vertex[h] == topology_.corner_vertex[o];
      found.emplace_back(t, turned ? Vec3f{-n.x, -n.y, -n.z} : n);
    }
    for (const auto& [t, normal] : found) topology_.normals[t] = normal;
    std::erase_if(waiting_, [&](std::uint32_t t) { return known(t); });
    return !found.empty();
  }

  // Returns the half-edge of t across which there is a normal, or kNoIndex.
  std::uint32_t lender(std::uint32_t t) const {
    std::uint32_t best = kNoIndex;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o == kNoIndex || !known(o / 3)) continue;
      if (best == kNoIndex || edge_length(topology_, h) > edge_length(topology_, best)) best = h;
    }
    return best;
  }

  void take_out(std::uint32_t t) {
    topology_.flags[t] = Topology::kDegenerate;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = std::exchange(topology_.opposite[h], kNoIndex);
      if (o != kNoIndex) topology_.opposite[o] = kNoIndex;
    }
  }

  Topology& topology_;
  std::vector<std::uint32_t> waiting_;
};

}  // namespace

RoundingLimit::RoundingLimit(const Topology& topology) {
  double largest = 0;
  for (const Vec3f& p : topology.points)
    largest =
        std::max({largest, std::abs(double{p.x}), std::abs(double{p.y}), std::abs(double{p.z})});
  most_ = 2 * kFloatStep * largest;  // the root of 3 along a diagonal, rounded up
}

// Coordinates differ in size, and so does their rounding: a thin mesh along an axis has normals.
bool RoundingLimit::lies_within(const std::array<glm::dvec3, 3>& p, const glm::dvec3& cross,
                                double longest) {
  const std::array<glm::dvec3, 3> edges{p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const glm::dvec3& base = *std::max_element(
      edges.begin(), edges.end(),
      [](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, a) < glm::dot(b, b); });
  const glm::dvec3 altitude = glm::abs(glm::normalize(glm::cross(cross, base)));
  const glm::dvec3 size = glm::max(glm::abs(p[0]), glm::max(glm::abs(p[1]), glm::abs(p[2])));
  const double moved = kFloatStep * glm::dot(altitude, size);
  return glm::dot(cross, cross) <= moved * moved * longest;
}

void borrow_normals(Topology& topology, std::vector<std::uint32_t> thin) {
  NormalLender(topology, std::move(thin)).run();
}

}  // namespace atlas
