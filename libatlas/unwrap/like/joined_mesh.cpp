#include "libatlas/unwrap/like/joined_mesh.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>

#include "libatlas/charts/mesh/weld.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

struct EdgeSide {
  std::uint32_t low, high, half_edge;
  bool operator==(const EdgeSide&) const = default;
};

}  // namespace

JoinedMesh join_triangles(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                          std::span<const std::uint32_t> objects) {
  WeldedVertices welded =
      weld_vertices(positions, used_vertices(indices, positions.size()), objects);
  JoinedMesh mesh;
  mesh.points = std::move(welded.points);
  for (std::size_t p = 0; !objects.empty() && p < welded.source.size(); ++p)
    mesh.objects.push_back(objects[welded.source[p]]);
  mesh.corners.reserve(indices.size());
  for (const std::uint32_t v : indices) mesh.corners.push_back(welded.place[v]);
  std::vector<EdgeSide> sides;
  sides.reserve(indices.size());
  for (std::uint32_t h = 0; h < indices.size(); ++h) {
    const auto [a, b] = std::minmax(mesh.corners[h], mesh.corners[next_half_edge(h)]);
    if (a != b) sides.push_back({a, b, h});
  }
  sort_total(sides.begin(), sides.end(), [](const EdgeSide& a, const EdgeSide& b) {
    return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
  });
  mesh.across.assign(indices.size(), kNoIndex);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].low == sides[begin].low &&
           sides[end].high == sides[begin].high)
      ++end;
    if (end - begin != 2) continue;
    mesh.across[sides[begin].half_edge] = sides[begin + 1].half_edge;
    mesh.across[sides[begin + 1].half_edge] = sides[begin].half_edge;
  }
  return mesh;
}

double mean_edge(const JoinedMesh& mesh) {
  double sum = 0;
  for (std::uint32_t h = 0; h < mesh.corners.size(); ++h)
    sum += glm::distance(to_dvec(mesh.points[mesh.corners[h]]),
                         to_dvec(mesh.points[mesh.corners[next_half_edge(h)]]));
  return mesh.corners.empty() ? 0 : sum / double(mesh.corners.size());
}

}  // namespace atlas
