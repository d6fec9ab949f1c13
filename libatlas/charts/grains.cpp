#include "libatlas/charts/grains.h"

#include <algorithm>
#include <utility>

namespace atlas {
namespace {

// Breadth-first patches of about `size` triangles that lean less than 45 degrees to their first.
class GrainBuilder {
 public:
  GrainBuilder(const Topology& topology, const CellOptions& options)
      : topology_(topology), options_(options) {}

  Grains run() {
    const PieceList pieces(topology_);
    grains_.of_triangle.assign(topology_.triangle_count(), kNoIndex);
    for (std::uint32_t k = 0; k + 1 < pieces.first.size(); ++k) {
      const std::size_t n = pieces.first[k + 1] - pieces.first[k];
      const std::size_t size = std::max<std::size_t>(1, n / (12 * cell_budget(n, options_)));
      for (std::uint32_t i = pieces.first[k]; i < pieces.first[k + 1]; ++i) {
        if (grains_.of_triangle[pieces.triangles[i]] == kNoIndex) {
          grow(pieces.triangles[i], k, size);
        }
      }
    }
    connect();
    return std::move(grains_);
  }

 private:
  void grow(std::uint32_t seed, std::uint32_t component, std::size_t size) {
    const auto grain = static_cast<std::uint32_t>(grains_.count());
    const glm::vec3 axis = to_glm(topology_.calm_normal(seed));
    queue_.assign(1, seed);
    grains_.of_triangle[seed] = grain;
    glm::vec3 normal(0), middle(0);
    float area = 0;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const std::uint32_t t = queue_[i];
      const float a = topology_.areas[t];
      area += a;
      normal += a * to_glm(topology_.normals[t]);
      middle += a * centroid(topology_, t);
      for (std::uint32_t h = 3 * t; h < 3 * t + 3 && queue_.size() < size; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || grains_.of_triangle[o / 3] != kNoIndex) continue;
        if (glm::dot(axis, to_glm(topology_.calm_normal(o / 3))) < 0.7f) continue;
        grains_.of_triangle[o / 3] = grain;
        queue_.push_back(o / 3);
      }
    }
    const float length = glm::length(normal);
    grains_.area.push_back(area);
    grains_.size.push_back(static_cast<std::uint32_t>(queue_.size()));
    grains_.centroid.push_back(area > 0 ? middle / area : centroid(topology_, seed));
    grains_.normal.push_back(length > 0 ? normal / length : axis);
    grains_.component.push_back(component);
  }

  void connect() {
    std::vector<std::uint64_t> links;
    for (std::uint32_t h = 0; h < topology_.opposite.size(); ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o == kNoIndex) continue;
      const std::uint64_t a = grains_.of_triangle[h / 3], b = grains_.of_triangle[o / 3];
      if (a != b) links.push_back(a << 32 | b);
    }
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
    grains_.first.assign(grains_.count() + 1, 0);
    for (const std::uint64_t link : links) ++grains_.first[(link >> 32) + 1];
    for (std::size_t i = 1; i < grains_.first.size(); ++i) grains_.first[i] += grains_.first[i - 1];
    for (const std::uint64_t link : links) {
      grains_.neighbour.push_back(static_cast<std::uint32_t>(link));
    }
  }

  const Topology& topology_;
  const CellOptions& options_;
  Grains grains_;
  std::vector<std::uint32_t> queue_;
};

}  // namespace

std::uint32_t cell_budget(std::size_t triangles, const CellOptions& options) {
  const std::size_t wanted = triangles / options.triangles_per_cell;
  return static_cast<std::uint32_t>(
      std::clamp<std::size_t>(wanted, 1, options.max_cells_per_piece));
}

Grains grow_grains(const Topology& topology, const CellOptions& options) {
  return GrainBuilder(topology, options).run();
}

}  // namespace atlas
