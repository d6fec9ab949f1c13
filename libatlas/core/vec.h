// Plain vectors for public headers. They carry no arithmetic on purpose: inside the library the
// algebra is GLM's (core/glm_bridge.h) or Eigen's, and neither leaks to those who include us.
#pragma once

namespace atlas {

struct Vec2f {
  float x = 0, y = 0;
  bool operator==(const Vec2f&) const = default;
};
struct Vec2d {
  double x = 0, y = 0;
  bool operator==(const Vec2d&) const = default;
};
struct Vec3f {
  float x = 0, y = 0, z = 0;
  bool operator==(const Vec3f&) const = default;
};
struct Vec3d {
  double x = 0, y = 0, z = 0;
  bool operator==(const Vec3d&) const = default;
};

}  // namespace atlas
