#include "libatlas/sheets/triangle_tree.h"
#include <algorithm>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr int kBits = 21;  // of a Morton code, for each axis

// Returns the low 21 bits of a value with two zeros after each bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffu;
  x = (x | x << 16) & 0x001f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                           std::vector<std::uint32_t> triangles)
    : triangles_(std::move(triangles)) {
  const auto corner = [&](std::uint32_t t, int k) {
    return to_glm(positions[indices[3 * std::size_t(t) + std::size_t(k)]]);
  };
  Box all;
  for (const std::uint32_t t : triangles_)
    for (int k = 0; k < 3; ++k) all.add(corner(t, k));
  const glm::dvec3 low(all.low), size = glm::dvec3(all.high) - low;
  const double scale = ((1 << kBits) - 1) / std::max({size.x, size.y, size.z, 1e-300});
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  sorted.reserve(triangles_.size());
  for (const std::uint32_t t : triangles_) {
    const glm::dvec3 sum =
        glm::dvec3(corner(t, 0)) + glm::dvec3(corner(t, 1)) + glm::dvec3(corner(t, 2));
    const glm::dvec3 q = (sum / 3.0 - low) * scale;
    sorted.emplace_back(spread(std::uint64_t(std::max(q.x, 0.0))) |
                            spread(std::uint64_t(std::max(q.y, 0.0))) << 1 |
                            spread(std::uint64_t(std::max(q.z, 0.0))) << 2,
                        t);
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i) triangles_[i] = sorted[i].second;

  std::size_t count = triangles_.size();
  while (count > 0 && (levels_.empty() || count > 1)) {
    std::vector<Box> boxes;
    for (std::size_t begin = 0; begin < count; begin += kChildren) {
      Box& box = boxes.emplace_back();
      for (std::size_t i = begin; i < std::min(begin + kChildren, count); ++i) {
        for (int k = 0; levels_.empty() && k < 3; ++k) box.add(corner(triangles_[i], k));
        if (levels_.empty()) continue;
        box.add(levels_.back()[i].low);
        box.add(levels_.back()[i].high);
      }
    }
    count = boxes.size();
    levels_.push_back(std::move(boxes));
  }
}

}  // namespace atlas
