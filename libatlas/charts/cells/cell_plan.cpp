#include "libatlas/charts/cells/cell_plan.h"

#include <algorithm>
#include <span>
#include <utility>

namespace atlas {
namespace {

constexpr std::uint32_t kLeastPerCell = 3;
// kCellsAHandle cells are added for each boundary loop of a piece, and twice as many for each
// handle, as long as its cells keep kLeastTriangles triangles. Without them plates full of holes
// came out in half as many charts again (35 generated meshes).
constexpr std::size_t kCellsAHandle = 10, kLeastTriangles = 40;

// In a mesh of that many triangles.
std::uint32_t bounded_per_cell(std::size_t triangles, const CellOptions& options) {
  return std::clamp(static_cast<std::uint32_t>(triangles / options.cells_of_small_mesh),
                    std::min(kLeastPerCell, options.triangles_per_cell),
                    options.triangles_per_cell);
}

class CellBudget {
 public:
  CellBudget(const Topology& topology, const CellOptions& options)
      : topology_(topology),
        options_(options),
        triangles_per_cell_(triangles_per_cell(topology, options)),
        seen_in_(topology.points.size(), kNoIndex) {}

  std::uint32_t of(std::size_t handles, std::size_t n) const {
    const std::size_t least =
        n / (options_.each_piece_alone ? bounded_per_cell(n, options_) : triangles_per_cell_);
    const std::size_t most = std::max(least, n / kLeastTriangles);
    const std::size_t wanted = least + kCellsAHandle * handles;
    return static_cast<std::uint32_t>(
        std::clamp<std::size_t>(std::min(wanted, most), 1, options_.max_cells_per_piece));
  }

  // Returns 2 - Euler characteristic: each handle counts two, each boundary loop one.
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
  std::uint32_t triangles_per_cell_;
  std::vector<std::uint32_t> seen_in_;  // one per vertex: the last piece that it was found in
};

}  // namespace

std::uint32_t triangles_per_cell(const Topology& topology, const CellOptions& options) {
  return bounded_per_cell(std::max(options.mesh_triangles, topology.triangle_count()), options);
}

CellPlan plan_cells(const Topology& topology, const CellOptions& options) {
  CellPlan plan{PieceList(topology), {}, {}};
  CellBudget budget(topology, options);
  for (std::uint32_t k = 0; k < plan.pieces.count(); ++k) {
    const std::span<const std::uint32_t> triangles = plan.pieces.of(k);
    const std::size_t handles = budget.handles(k, triangles);
    plan.cells.push_back(budget.of(handles, triangles.size()));
    plan.pierced.push_back(handles > 1);
  }
  return plan;
}

}  // namespace atlas
