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

// Clip from world, OpenGL's clip space; aspect is width / height. A camera that looks along its
// `up` has some axis at the image's upper edge.
Matrix4 view_projection(const Camera& camera, double aspect);

// The corners of the view volume between its near plane and `far` (or its far plane, if nearer).
std::array<Vec3d, 8> view_corners(const Camera& camera, double aspect, double far);

// Looks at the whole box from a direction a little above its side; the planes enclose the box. The
// wider the field of view, the nearer it stands.
Camera camera_for(const Box3& box, const Vec3d& up, double fov_degrees);

// Near and far planes that enclose the box from where the camera stands; from within, what is a
// ten-thousandth of its diagonal or more away.
void fit_planes(Camera& camera, const Box3& box);

// Moves along the view (forward, right, up; world units) and turns it (degrees; pitch is limited).
void fly(Camera& camera, const Vec3d& forward_right_up, double yaw, double pitch);

}  // namespace atlas
