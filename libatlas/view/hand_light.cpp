#include "libatlas/view/hand_light.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

struct LightAxes {
  glm::dvec3 up, side, other;
};

LightAxes axes_around(const Vec3d& up_axis) {
  const glm::dvec3 up = glm::normalize(to_glm(up_axis));
  const glm::dvec3 across = std::abs(up.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 side = glm::normalize(glm::cross(up, across));
  return {up, side, glm::cross(up, side)};
}

}  // namespace

Vec3d hand_direction(const HandLight& light, const Vec3d& up) {
  const LightAxes axes = axes_around(up);
  const double a = glm::radians(double(light.azimuth)), e = glm::radians(double(light.elevation));
  return from_glm((axes.side * std::cos(a) + axes.other * std::sin(a)) * std::cos(e) +
                  axes.up * std::sin(e));
}

HandLight hand_light_of(const Vec3d& direction, const Vec3d& up) {
  const LightAxes axes = axes_around(up);
  const glm::dvec3 d = glm::normalize(to_glm(direction));
  const double azimuth = glm::degrees(std::atan2(glm::dot(d, axes.other), glm::dot(d, axes.side)));
  const double elevation = glm::degrees(std::asin(std::clamp(glm::dot(d, axes.up), -1.0, 1.0)));
  return {float(azimuth < 0 ? azimuth + 360 : azimuth),
          std::clamp(float(elevation), -kSteepestHandLight, kSteepestHandLight)};
}

}  // namespace atlas
