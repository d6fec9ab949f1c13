#include "libatlas/charts/merging/coarse_uv.h"

#include <cmath>

#include "libatlas/charts/geometry/tangents.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {

void project_cell(const CoarseMesh& mesh, std::uint32_t k, CoarseUv& uv) {
  const CoarseCell& cell = mesh.cells[k];
  const Tangents plane(to_glm(cell.normal));
  uv.centre[k] = {0, 0};
  for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
    const glm::dvec3 d = to_glm(mesh.slot_position[s]) - to_glm(cell.centre);
    const glm::dvec2 flat = plane.of(d);
    const double length = glm::length(flat);
    uv.slot[s] = from_glm(length > 0 ? flat * (glm::length(d) / length) : flat);
  }
}

std::array<Vec3d, 2> cell_frame(const CoarseMesh& mesh, const CoarseUv& uv, std::uint32_t k) {
  const CoarseCell& cell = mesh.cells[k];
  const Tangents plane(to_glm(cell.normal));
  double c = 0, s = 0;
  for (std::uint32_t i = cell.first_slot; i < cell.first_slot + cell.slot_count; ++i) {
    const glm::dvec2 a = plane.of(to_glm(mesh.slot_position[i]) - to_glm(cell.centre));
    const glm::dvec2 b = to_glm(uv.slot[i]) - to_glm(uv.centre[k]);
    c += glm::dot(a, b);
    s += a.x * b.y - a.y * b.x;
  }
  const double norm = std::sqrt(c * c + s * s);
  if (!(norm > 0)) return {from_glm(plane.u), from_glm(plane.v)};
  c /= norm;
  s /= norm;
  return {from_glm(c * plane.u - s * plane.v), from_glm(s * plane.u + c * plane.v)};
}

}  // namespace atlas
