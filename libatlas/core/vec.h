// Plain vectors for the public headers. They deliberately have no arithmetic: inside the library,
// GLM (core/glm_bridge.h) or Eigen does the algebra, and programs that include the public headers
// need neither.
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
