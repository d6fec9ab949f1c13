#include "libatlas/charts/part_of_chart.h"

#include <array>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/halfedges.h"
#include "libatlas/param/orient.h"

namespace atlas {

FlatChart part_of_chart(const FlattenInput& input, const FlatChart& whole,
                        std::span<const std::uint32_t> triangles) {
  FlatChart piece;
  piece.planar = whole.planar;
  piece.fragment = whole.fragment;
  std::vector<std::uint32_t> local(whole.uvs.size(), kNoIndex);
  std::vector<Vec3d> positions;
  std::vector<double> density;
  for (const std::uint32_t i : triangles) {
    piece.triangles.push_back(whole.triangles[i]);
    piece.corners.push_back(whole.corners[i]);
    for (std::uint32_t& c : piece.corners.back()) {
      if (local[c] == kNoIndex) {
        local[c] = std::uint32_t(piece.uvs.size());
        piece.uvs.push_back(whole.uvs[c]);
        piece.vertex.push_back(whole.vertex[c]);
        const Vec3d p = from_glm(to_dvec(input.topology.points[whole.vertex[c]]));
        positions.push_back(p);
      }
      c = local[c];
    }
    if (!input.density.empty()) density.push_back(input.density[whole.triangles[i]]);
  }
  const Vec3d origin = positions[0];
  for (Vec3d& p : positions) p = {p.x - origin.x, p.y - origin.y, p.z - origin.z};
  std::vector<std::array<std::uint32_t, 2>> border;
  param::HalfEdges half_edges;
  half_edges.build(piece.corners, piece.uvs.size());
  for (std::uint32_t h = 0; h < 3 * piece.corners.size(); ++h) {
    if (half_edges.opposite(h) == param::HalfEdges::none) {
      border.push_back({half_edges.from(h), half_edges.to(h)});
    }
  }
  piece.size = orient_for_packing(piece.uvs, border).size;
  piece.distortion = measure_distortion({positions, piece.corners, density}, piece.uvs);
  piece.cone = normal_cone(input.topology.normals, piece.triangles);
  return piece;
}

}  // namespace atlas
