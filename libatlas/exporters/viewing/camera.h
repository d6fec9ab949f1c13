// Internal: a view direction as the rotation that file formats store.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/core/glm_bridge.h"

namespace atlas {

// Returns the unit quaternion (x, y, z, w) that turns the default camera of VRML and glTF (looking
// along -Z, +Y up) to look along `direction` without roll: a pitch about X, then a yaw about Y.
inline std::array<double, 4> camera_rotation(glm::dvec3 direction) {
  direction = glm::normalize(direction);
  const double yaw = std::atan2(-direction.x, -direction.z) / 2;
  const double pitch = std::asin(std::clamp(direction.y, -1.0, 1.0)) / 2;
  return {std::cos(yaw) * std::sin(pitch), std::sin(yaw) * std::cos(pitch),
          -std::sin(yaw) * std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
}

// Converts coordinates of a z-up system to those of a y-up one: +Z becomes +Y.
inline glm::dvec3 z_up_to_y_up(const glm::dvec3& v) {
  return {v.x, v.z, -v.y};
}

}  // namespace atlas
