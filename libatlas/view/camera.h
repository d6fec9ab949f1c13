// A perspective camera that flies freely.
#pragma once

#include <array>

#include "libatlas/shadow/fit.h"

namespace atlas {

struct Camera {
  Vec3d eye{0, 0, 5}, target{0, 0, 0}, up{0, 1, 0};
  double fov_degrees = 60;  // vertical
  double near_plane = 0.01, far_plane = 100;
};

// Returns the matrix from world space to OpenGL's clip space; aspect is width / height. If the
// camera looks along its `up`, another axis takes its place.
Matrix4 view_projection(const Camera& camera, double aspect);

// Returns the corners of the view volume between its near plane and `far` (or its far plane, if
// nearer).
std::array<Vec3d, 8> view_corners(const Camera& camera, double aspect, double far);

// Returns a camera that looks at the whole box from slightly above its side; its planes enclose the
// box. The wider the field of view, the nearer it stands.
Camera camera_for(const Box3& box, const Vec3d& up, double fov_degrees);

// Sets near and far planes that enclose the box as seen from the camera. The near plane is at least
// a millionth of the far plane's distance away, also within the box.
void fit_planes(Camera& camera, const Box3& box);

// Moves the camera in world units (forward and right along its view, up along its `up`) and turns
// it (degrees; yaw to the right, pitch upwards to at most 88 degrees from level).
void fly(Camera& camera, const Vec3d& forward_right_up, double yaw, double pitch);

}  // namespace atlas
