#include "libatlas/charts/part_of_chart.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "libatlas/core/glm_bridge.h"
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
  std::map<std::array<std::uint32_t, 2>, int> sides;
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
    const auto& c = piece.corners.back();
    for (int k = 0; k < 3; ++k)
      ++sides[{std::min(c[k], c[(k + 1) % 3]), std::max(c[k], c[(k + 1) % 3])}];
    if (!input.density.empty()) density.push_back(input.density[whole.triangles[i]]);
  }
  const Vec3d origin = positions[0];
  for (Vec3d& p : positions) p = {p.x - origin.x, p.y - origin.y, p.z - origin.z};
  std::vector<std::array<std::uint32_t, 2>> border;
  for (const auto& [edge, count] : sides) {
    if (count == 1) border.push_back(edge);
  }
  piece.size = orient_for_packing(piece.uvs, border).size;
  piece.distortion = measure_distortion({positions, piece.corners, density}, piece.uvs);
  piece.cone = normal_cone(input.topology.normals, piece.triangles);
  return piece;
}

}  // namespace atlas
