#include "libatlas/charts/flattening/touching.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/injectivity.h"

namespace atlas {
namespace {

// Relative to the chart's width: the deepest overlap that is taken for rounding (six decimals of a
// texcoord are a hundred-thousandth of a chart that is a twentieth of its page), the gap that is
// left, and how far a vertex may go in all.
constexpr double kDeepest = 1e-5, kGap = 1e-7, kFarthest = 4e-5;
constexpr std::size_t kMostCrossings = 4096;  // of a round
constexpr int kRounds = 8;

using Edge = std::array<std::uint32_t, 2>;

class Parting {
 public:
  Parting(double width, std::span<Vec2d> uvs) : width_(width), uvs_(uvs) {}

  // Moves the ends of both edges that are near the other one to its outer side. Returns whether
  // there are any.
  bool part(const BorderCrossing& crossing) {
    const auto& [a, b] = std::pair(crossing.a, crossing.b);
    bool near = false;
    for (const std::uint32_t v : a) near |= leave(v, b);
    for (const std::uint32_t v : b) near |= leave(v, a);
    return near;
  }

 private:
  // The triangle of an edge lies to its left.
  bool leave(std::uint32_t v, const Edge& edge) {
    if (v == edge[0] || v == edge[1]) return false;
    const glm::dvec2 from = to_glm(uvs_[edge[0]]), along = to_glm(uvs_[edge[1]]) - from;
    const double length = glm::length(along);
    if (!(length > 0)) return false;
    const glm::dvec2 out{along.y / length, -along.x / length}, to = to_glm(uvs_[v]) - from;
    const double deepest = kDeepest * width_, at = glm::dot(to, along) / length;
    const double outside = glm::dot(to, out);
    if (at < -deepest || at > length + deepest || std::abs(outside) > deepest) return false;
    if (outside < kGap * width_) {
      uvs_[v] = from_glm(to_glm(uvs_[v]) + (kGap * width_ - outside) * out);
    }
    return true;
  }

  double width_;
  std::span<Vec2d> uvs_;
};

}  // namespace

bool part_touching(const LocalMesh& mesh, double width, std::span<Vec2d> uvs) {
  // Most charts that cross themselves do so deeply: the few crossings of the usual check tell.
  Injectivity check = check_injectivity(mesh, uvs);
  if (check.injective) return true;
  const std::vector<Vec2d> before(uvs.begin(), uvs.end());
  Parting parting(width, uvs);
  for (int round = 0; round < kRounds && !check.injective; ++round) {
    if (!check.flipped.empty() || check.crossings.empty()) return false;
    for (const BorderCrossing& crossing : check.crossings) {
      if (!parting.part(crossing)) return false;
    }
    check = check_injectivity(mesh, uvs, {.max_crossings = kMostCrossings});
  }
  if (!check.injective) return false;
  for (std::size_t v = 0; v < uvs.size(); ++v) {
    if (glm::length(to_glm(uvs[v]) - to_glm(before[v])) > kFarthest * width) return false;
  }
  return true;
}

}  // namespace atlas
