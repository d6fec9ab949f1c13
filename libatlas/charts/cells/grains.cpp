#include "libatlas/charts/cells/grains.h"

#include <algorithm>
#include <span>
#include <utility>

namespace atlas {
namespace {

// Grows breadth-first patches of about `size` triangles whose normals are within 45 degrees of that
// of the first triangle.
class GrainBuilder {
 public:
  explicit GrainBuilder(const CellInput& input) : input_(input), topology_(input.topology) {}

  Grains run() {
    const auto& [pieces, cells, pierced] = input_.plan;
    grains_.of_triangle.assign(topology_.triangle_count(), kNoIndex);
    for (std::uint32_t k = 0; k < pieces.count(); ++k) {
      if (!input_.left_out.empty() && input_.left_out[k]) continue;
      const std::span<const std::uint32_t> triangles = pieces.of(k);
      const std::size_t size = std::max<std::size_t>(1, triangles.size() / (12 * cells[k]));
      for (const std::uint32_t t : triangles) {
        if (grains_.of_triangle[t] == kNoIndex) grow(t, k, size);
      }
    }
    row_.push_back(static_cast<std::uint32_t>(order_.size()));
    connect();
    return std::move(grains_);
  }

 private:
  void grow(std::uint32_t seed, std::uint32_t component, std::size_t size) {
    const auto grain = static_cast<std::uint32_t>(grains_.count());
    const glm::vec3 axis = to_glm(topology_.calm_normal(seed));
    const std::size_t first = order_.size();
    row_.push_back(static_cast<std::uint32_t>(first));
    order_.push_back(seed);
    grains_.of_triangle[seed] = grain;
    glm::vec3 normal(0), middle(0);
    float area = 0;
    for (std::size_t i = first; i < order_.size(); ++i) {
      const std::uint32_t t = order_[i];
      const float a = topology_.areas[t];
      area += a;
      normal += a * to_glm(topology_.normals[t]);
      middle += a * centroid(topology_, t);
      for (std::uint32_t h = 3 * t; h < 3 * t + 3 && order_.size() - first < size; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || grains_.of_triangle[o / 3] != kNoIndex) continue;
        if (input_.walled(t, o / 3)) continue;
        if (glm::dot(axis, to_glm(topology_.calm_normal(o / 3))) < 0.7f) continue;
        grains_.of_triangle[o / 3] = grain;
        order_.push_back(o / 3);
      }
    }
    grains_.area.push_back(area);
    grains_.size.push_back(static_cast<std::uint32_t>(order_.size() - first));
    grains_.centroid.push_back(area > 0 ? middle / area : centroid(topology_, seed));
    grains_.normal.push_back(unit_or(normal, axis));
    grains_.component.push_back(component);
  }

  // Links neighbouring grains. Each row is in ascending order.
  void connect() {
    const auto count = static_cast<std::uint32_t>(grains_.count());
    std::vector<std::uint32_t> met(count, kNoIndex);  // the last grain that met it
    std::vector<std::uint32_t>& rows = grains_.neighbour;
    grains_.first.reserve(count + 1);
    for (std::uint32_t g = 0; g < count; ++g) {
      const std::size_t begin = rows.size();
      grains_.first.push_back(static_cast<std::uint32_t>(begin));
      for (std::uint32_t i = row_[g]; i < row_[g + 1]; ++i) {
        for (std::uint32_t h = 3 * order_[i]; h < 3 * order_[i] + 3; ++h) {
          const std::uint32_t o = topology_.opposite[h];
          if (o == kNoIndex || input_.walled(h / 3, o / 3)) continue;
          const std::uint32_t other = grains_.of_triangle[o / 3];
          if (other == g || met[other] == g) continue;
          met[other] = g;
          rows.push_back(other);
        }
      }
      std::sort(rows.begin() + static_cast<std::ptrdiff_t>(begin), rows.end());
    }
    grains_.first.push_back(static_cast<std::uint32_t>(rows.size()));
    for (std::uint32_t g = 0; g < count; ++g) {
      for (std::uint32_t i = grains_.first[g]; i < grains_.first[g + 1]; ++i) {
        grains_.distance.push_back(glm::distance(grains_.centroid[g], grains_.centroid[rows[i]]));
      }
    }
  }

  const CellInput& input_;
  const Topology& topology_;
  Grains grains_;
  // Triangles sorted by grain; where each grain begins, and the end.
  std::vector<std::uint32_t> order_, row_;
};

}  // namespace

Grains grow_grains(const CellInput& input) {
  return GrainBuilder(input).run();
}

}  // namespace atlas
