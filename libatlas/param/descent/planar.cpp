#include "libatlas/param/descent/planar.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Returns twice the area times the unit normal.
glm::dvec3 area_vector(const LocalMesh& mesh, std::size_t t) {
  const auto& tri = mesh.triangles[t];
  const glm::dvec3 p = to_glm(mesh.positions[tri[0]]);
  return glm::cross(to_glm(mesh.positions[tri[1]]) - p, to_glm(mesh.positions[tri[2]]) - p);
}

// Returns two unit vectors that form a right-handed frame with the unit vector n. The first is made
// from the coordinate axis farthest from n.
std::array<glm::dvec3, 2> frame_of(const glm::dvec3& n) {
  const glm::dvec3 a = glm::abs(n);
  glm::dvec3 other(0);
  other[a.x <= a.y && a.x <= a.z ? 0 : a.y <= a.z ? 1 : 2] = 1;
  const glm::dvec3 u = glm::normalize(glm::cross(other, n));
  return {u, glm::cross(n, u)};
}

}  // namespace

void project_planar(const LocalMesh& mesh, Vec3d axis, std::span<Vec2d> uvs) {
  assert(uvs.size() == mesh.positions.size());
  const auto frame = frame_of(glm::normalize(to_glm(axis)));
  for (std::size_t v = 0; v < uvs.size(); ++v) {
    const glm::dvec3 p = to_glm(mesh.positions[v]);
    uvs[v] = {glm::dot(p, frame[0]), glm::dot(p, frame[1])};
  }
}

double planar_stretch_bound(const LocalMesh& mesh, Vec3d axis) {
  const glm::dvec3 n = glm::normalize(to_glm(axis));
  double least = 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::dvec3 a = area_vector(mesh, t);
    const double length = glm::length(a);
    if (length > 0) least = std::min(least, glm::dot(a, n) / length);
  }
  return least > 0 ? 1 / least : std::numeric_limits<double>::infinity();
}

double projected_share(const LocalMesh& mesh, Vec3d axis) {
  glm::dvec3 sum(0);
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::dvec3 a = area_vector(mesh, t);
    sum += a;
    area += glm::length(a);
  }
  return area > 0 ? glm::dot(sum, glm::normalize(to_glm(axis))) / area : 1;
}

Vec3d mean_normal(const LocalMesh& mesh) {
  glm::dvec3 sum(0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += area_vector(mesh, t);
  const double length = glm::length(sum);
  if (!(length > 0)) return {0, 0, 1};
  return from_glm(glm::dvec3(sum / length));
}

}  // namespace atlas
