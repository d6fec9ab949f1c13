#include "libatlas/charts/flattening/newcomers.h"

#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

bool placed(const Vec2d& uv) {
  return !std::isnan(uv.x);
}

// Places triangle t on its edge whose ends are placed. Returns false if there is no such edge.
bool lay_down(const LocalMesh& mesh, std::size_t t, std::span<Vec2d> uvs) {
  const auto& v = mesh.triangles[t];
  int known = 0, apex = 0;
  for (int i = 0; i < 3; ++i) {
    known += placed(uvs[v[i]]);
    if (!placed(uvs[v[i]])) apex = i;
  }
  if (known == 3) return true;
  if (known < 2) return false;
  const std::uint32_t a = v[(apex + 1) % 3], b = v[(apex + 2) % 3];
  const glm::dvec3 from = to_glm(mesh.positions[a]);
  const glm::dvec3 edge = to_glm(mesh.positions[b]) - from;
  const glm::dvec3 side = to_glm(mesh.positions[v[apex]]) - from;
  const double squared = glm::dot(edge, edge);
  if (!(squared > 0)) return false;
  const double along = glm::dot(side, edge) / squared;
  const double across = glm::length(glm::cross(edge, side)) / squared;
  const glm::dvec2 base = to_glm(uvs[a]), flat = to_glm(uvs[b]) - base;
  uvs[v[apex]] = from_glm(base + along * flat + across * glm::dvec2(-flat.y, flat.x));
  return true;
}

}  // namespace

bool place_newcomers(const LocalMesh& mesh, std::span<const Vec2d> corner_uvs,
                     std::vector<Vec2d>& uvs) {
  uvs.assign(mesh.positions.size(), unplaced());
  std::vector<std::size_t> rest;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!placed(corner_uvs[3 * t])) rest.push_back(t);
    for (std::size_t i = 0; i < 3 && placed(corner_uvs[3 * t]); ++i) {
      uvs[mesh.triangles[t][i]] = corner_uvs[3 * t + i];
    }
  }
  for (std::size_t left = rest.size() + 1; rest.size() < left;) {
    left = rest.size();
    std::erase_if(rest, [&](std::size_t t) { return lay_down(mesh, t, uvs); });
  }
  return rest.empty();
}

}  // namespace atlas
