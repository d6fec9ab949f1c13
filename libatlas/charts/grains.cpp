#include "libatlas/charts/grains.h"

#include <algorithm>
#include <span>
#include <utility>

namespace atlas {
namespace {

// Cells for each handle and each loop of the border, as long as cells have so many triangles:
// without these plates full of holes came out in half as many charts again (35 generated meshes).
constexpr std::size_t kCellsAHandle = 10, kLeastTriangles = 40;

// How many cells each piece gets.
class CellBudget {
 public:
  CellBudget(const Topology& topology, const CellOptions& options)
      : topology_(topology), options_(options), seen_in_(topology.points.size(), kNoIndex) {}

  std::uint32_t of(std::size_t handles, std::size_t n) const {
    const std::size_t least = n / options_.triangles_per_cell;
    const std::size_t most = std::max(least, n / kLeastTriangles);
    const std::size_t wanted = least + kCellsAHandle * handles;
    return static_cast<std::uint32_t>(
        std::clamp<std::size_t>(std::min(wanted, most), 1, options_.max_cells_per_piece));
  }

  // By Euler's formula: a handle counts twice, each loop of the border once.
  std::size_t handles(std::uint32_t piece, std::span<const std::uint32_t> triangles) {
    std::size_t vertices = 0, sides = 0;
    for (const std::uint32_t t : triangles) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        sides += topology_.opposite[h] == kNoIndex ? 2 : 1;
        vertices += std::exchange(seen_in_[topology_.corner_vertex[h]], piece) != piece;
      }
    }
    const std::size_t edges = sides / 2, others = vertices + triangles.size();
    return edges + 2 > others ? edges + 2 - others : 0;
  }

 private:
  const Topology& topology_;
  const CellOptions& options_;
  std::vector<std::uint32_t> seen_in_;  // 1 a vertex: the last piece that it was found in
};

// Breadth-first patches of about `size` triangles that lean less than 45 degrees to their first.
class GrainBuilder {
 public:
  GrainBuilder(const Topology& topology, const CellOptions& options)
      : topology_(topology), options_(options) {}

  Grains run() {
    const PieceList pieces(topology_);
    CellBudget budget(topology_, options_);
    grains_.of_triangle.assign(topology_.triangle_count(), kNoIndex);
    for (std::uint32_t k = 0; k + 1 < pieces.first.size(); ++k) {
      const std::size_t n = pieces.first[k + 1] - pieces.first[k];
      const std::size_t handles =
          budget.handles(k, std::span(pieces.triangles).subspan(pieces.first[k], n));
      grains_.cells.push_back(budget.of(handles, n));
      grains_.pierced.push_back(handles > 1);
      const std::size_t size = std::max<std::size_t>(1, n / (12 * grains_.cells[k]));
      for (std::uint32_t i = pieces.first[k]; i < pieces.first[k + 1]; ++i) {
        if (grains_.of_triangle[pieces.triangles[i]] == kNoIndex) {
          grow(pieces.triangles[i], k, size);
        }
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
        if (glm::dot(axis, to_glm(topology_.calm_normal(o / 3))) < 0.7f) continue;
        grains_.of_triangle[o / 3] = grain;
        order_.push_back(o / 3);
      }
    }
    const float length = glm::length(normal);
    grains_.area.push_back(area);
    grains_.size.push_back(static_cast<std::uint32_t>(order_.size() - first));
    grains_.centroid.push_back(area > 0 ? middle / area : centroid(topology_, seed));
    grains_.normal.push_back(length > 0 ? normal / length : axis);
    grains_.component.push_back(component);
  }

  // Each row ascending.
  void connect() {
    const auto count = static_cast<std::uint32_t>(grains_.count());
    std::vector<std::uint32_t> met(count, kNoIndex);  // by which grain last
    std::vector<std::uint32_t>& rows = grains_.neighbour;
    grains_.first.reserve(count + 1);
    for (std::uint32_t g = 0; g < count; ++g) {
      const std::size_t begin = rows.size();
      grains_.first.push_back(static_cast<std::uint32_t>(begin));
      for (std::uint32_t i = row_[g]; i < row_[g + 1]; ++i) {
        for (std::uint32_t h = 3 * order_[i]; h < 3 * order_[i] + 3; ++h) {
          const std::uint32_t o = topology_.opposite[h];
          if (o == kNoIndex) continue;
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

  const Topology& topology_;
  const CellOptions& options_;
  Grains grains_;
  std::vector<std::uint32_t> order_, row_;  // triangles by grain; where each begins, and the end
};

}  // namespace

Grains grow_grains(const Topology& topology, const CellOptions& options) {
  return GrainBuilder(topology, options).run();
}

}  // namespace atlas
