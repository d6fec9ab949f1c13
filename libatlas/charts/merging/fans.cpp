#include "libatlas/charts/merging/fans.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Altitudes are raised to at least this share of the base, which keeps the stiffness of slivers
// finite.
constexpr double kLeastAltitude = 1e-9;
// Two slots are one vertex of the mesh if their distance is at most this share of the triangle's
// longest edge.
constexpr double kSamePlace = 1e-9;

struct FanTriangle {
  glm::dvec2 slot_gradient{0}, next_gradient{0};
  double area = 0, inverse_area = 0, spoke_squared = 0, rim_squared = 0;
};

FanTriangle fan_triangle(const glm::dvec3& centre, const glm::dvec3& slot, const glm::dvec3& next) {
  const std::array<glm::dvec3, 3> edge = {slot - centre, next - slot, centre - next};
  std::array<double, 3> squared;
  for (int k = 0; k < 3; ++k) squared[k] = glm::dot(edge[k], edge[k]);
  FanTriangle fan;
  fan.spoke_squared = squared[0];
  fan.rim_squared = squared[1];
  // The longest edge is the base, so that nothing is divided by the short side of a sliver.
  const int k =
      static_cast<int>(std::max_element(squared.begin(), squared.end()) - squared.begin());
  if (squared[1] <= kSamePlace * kSamePlace * squared[k]) return fan;
  const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
  const double length = std::sqrt(squared[k]);
  const double foot = -glm::dot(edge[k], edge[k2]) / length;
  const double altitude = glm::length(glm::cross(edge[k], edge[k2])) / length;
  const double raised = std::max(altitude, kLeastAltitude * length);
  fan.area = 0.5 * length * altitude;
  fan.inverse_area = 2 / (length * raised);
  std::array<glm::dvec2, 3> gradient;
  gradient[k1] = {0.5 * raised, -0.5 * foot};
  gradient[k2] = {0, 0.5 * length};
  gradient[k] = -(gradient[k1] + gradient[k2]);
  fan.slot_gradient = gradient[1];
  fan.next_gradient = gradient[2];
  return fan;
}

}  // namespace

Fans::Fans(const CoarseMesh& mesh)
    : coupling(mesh.slot_position.size()), inverse_pivot(mesh.cells.size(), 0) {
  for (std::vector<double>* const values :
       {&slot_gradient_x, &slot_gradient_y, &next_gradient_x, &next_gradient_y, &area,
        &inverse_area, &spoke_squared, &rim_squared}) {
    values->resize(mesh.slot_position.size() + kBeyond, 0);
  }
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const CoarseCell& cell = mesh.cells[c];
    double pivot = 0;
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      const std::uint32_t next = mesh.next_slot(s, cell);
      const FanTriangle fan = fan_triangle(to_glm(cell.centre), to_glm(mesh.slot_position[s]),
                                           to_glm(mesh.slot_position[next]));
      const glm::dvec2 g1 = fan.slot_gradient, g2 = fan.next_gradient, g0 = -(g1 + g2);
      slot_gradient_x[s] = g1.x;
      slot_gradient_y[s] = g1.y;
      next_gradient_x[s] = g2.x;
      next_gradient_y[s] = g2.y;
      area[s] = fan.area;
      inverse_area[s] = fan.inverse_area;
      spoke_squared[s] = fan.spoke_squared;
      rim_squared[s] = fan.rim_squared;
      pivot += glm::dot(g0, g0) * fan.inverse_area;
      coupling[s].centre += glm::dot(g0, g1) * fan.inverse_area;
      coupling[next].centre += glm::dot(g0, g2) * fan.inverse_area;
      coupling[s].own += glm::dot(g1, g1) * fan.inverse_area;
      coupling[next].own += glm::dot(g2, g2) * fan.inverse_area;
      coupling[s].next += glm::dot(g1, g2) * fan.inverse_area;
    }
    if (pivot > 0) inverse_pivot[c] = 1 / pivot;
  }
}

}  // namespace atlas
