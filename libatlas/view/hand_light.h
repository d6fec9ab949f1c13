// Internal: a light that is turned by hand, by two angles.
#pragma once

#include "libatlas/core/vec.h"

namespace atlas {

// The direction towards the light, in degrees: the azimuth around the up axis, from an axis of the
// scene across it, and the elevation above the horizon.
struct HandLight {
  float azimuth = 45, elevation = 45;
};

// The steepest elevation up or down. Straight up, an azimuth says nothing.
inline constexpr float kSteepestHandLight = 89;

// Returns the direction towards the light, of length 1. `up` may have any length but 0.
Vec3d hand_direction(const HandLight& light, const Vec3d& up);

// Returns the angles of a light that comes from `direction`, of any length but 0. Light closer to
// the vertical than kSteepestHandLight is turned that far.
HandLight hand_light_of(const Vec3d& direction, const Vec3d& up);

}  // namespace atlas
