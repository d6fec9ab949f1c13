// Internal: triangles that have a place in the charts, with the orientation that they have there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"

namespace atlas {

// The triangles to write: those of the mesh that was charted, or simpler ones in the same charts.
// The data that the spans point at must outlive this struct.
struct WorldMesh {
  std::span<const std::uint32_t> indices;         // three per triangle, into MeshView::positions
  std::span<const std::uint32_t> uv_indices;      // three per triangle, into ChartSet::uvs
  std::span<const std::uint32_t> triangle_chart;  // one per triangle
  // One per triangle, or empty: whether it is seen from its front only (see sheets/one_sided.h).
  std::vector<bool> one_sided = {};
};

// The mesh's own triangles with the orientation that they have in the charts: the triangles in
// ChartSet::flipped_triangles are reversed. `indices` (MeshView::indices) and `charts` must outlive
// this object.
class ChartedMesh {
 public:
  ChartedMesh(std::span<const std::uint32_t> indices, const ChartSet& charts);
  WorldMesh view() const { return mesh_; }

 private:
  std::vector<std::uint32_t> indices_, uv_indices_;  // empty if no triangle is reversed
  WorldMesh mesh_;
};

}  // namespace atlas
