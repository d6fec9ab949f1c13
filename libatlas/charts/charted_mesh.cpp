#include "libatlas/charts/charted_mesh.h"

#include <utility>

namespace atlas {
namespace {

// Returns the corner list with the given triangles' orientation reversed.
std::vector<std::uint32_t> turned_round(std::span<const std::uint32_t> from,
                                        std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> corners(from.begin(), from.end());
  for (const std::uint32_t t : triangles) {
    std::swap(corners[3 * std::size_t(t) + 1], corners[3 * std::size_t(t) + 2]);
  }
  return corners;
}

}  // namespace

ChartedMesh::ChartedMesh(std::span<const std::uint32_t> indices, const ChartSet& charts)
    : mesh_{indices, charts.triangle_uv, charts.triangle_chart} {
  if (charts.flipped_triangles.empty()) return;
  indices_ = turned_round(indices, charts.flipped_triangles);
  uv_indices_ = turned_round(charts.triangle_uv, charts.flipped_triangles);
  mesh_.indices = indices_;
  mesh_.uv_indices = uv_indices_;
}

}  // namespace atlas
