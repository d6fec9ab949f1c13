#include "libatlas/view/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

struct Axes {
  glm::dvec3 forward, right, up;
};

// Returns the axis that is farthest from parallel to v.
glm::dvec3 axis_beside(const glm::dvec3& v) {
  const glm::dvec3 a = glm::abs(v);
  if (a.x <= a.y && a.x <= a.z) return {1, 0, 0};
  return a.y <= a.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
}

// Returns the radius of the sphere around a box. A box that floats cannot tell from a point gets
// some extent, so that a camera before it does not stand in its own target.
double radius_of(const Box3& box, const glm::dvec3& centre) {
  return std::max({glm::length(to_glm(box.high) - centre), 1e-9 * glm::length(centre), 1e-30});
}

// If the camera looks along its `up`, another axis takes the place of `up`.
Axes axes_of(const Camera& camera) {
  Axes a;
  a.forward = glm::normalize(to_glm(camera.target) - to_glm(camera.eye));
  const glm::dvec3 up = glm::normalize(to_glm(camera.up));
  glm::dvec3 right = glm::cross(a.forward, up);
  if (glm::length(right) < 1e-9) right = glm::cross(a.forward, axis_beside(up));
  a.right = glm::normalize(right);
  a.up = glm::cross(a.right, a.forward);
  return a;
}

}  // namespace

Matrix4 view_projection(const Camera& camera, double aspect) {
  const glm::dmat4 m = glm::perspective(glm::radians(camera.fov_degrees), aspect, camera.near_plane,
                                        camera.far_plane) *
                       glm::lookAt(to_glm(camera.eye), to_glm(camera.target), axes_of(camera).up);
  Matrix4 out;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) out[c * 4 + r] = m[c][r];
  return out;
}

std::array<Vec3d, 8> view_corners(const Camera& camera, double aspect, double far) {
  const Axes a = axes_of(camera);
  const double tangent = std::tan(glm::radians(camera.fov_degrees) / 2);
  std::array<Vec3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const double z = i & 4 ? std::min(far, camera.far_plane) : camera.near_plane;
    corners[i] = from_glm(to_glm(camera.eye) + z * a.forward +
                          z * tangent *
                              ((i & 1 ? aspect : -aspect) * a.right + (i & 2 ? 1.0 : -1.0) * a.up));
  }
  return corners;
}

void fit_planes(Camera& camera, const Box3& box) {
  const glm::dvec3 centre = (to_glm(box.low) + to_glm(box.high)) * 0.5;
  const double radius = radius_of(box, centre);
  const double distance = glm::length(to_glm(camera.eye) - centre);
  camera.far_plane = distance + radius * 1.01;
  // Near enough that a walker on 100 km of ground sees a wall at arm's length. Depths are floats,
  // which are densest far away: a floor of two triangles from the feet to the horizon is as clean
  // as with a factor of 1e-4.
  camera.near_plane = std::max(distance - radius * 1.01, camera.far_plane * 1e-6);
}

Camera camera_for(const Box3& box, const Vec3d& up, double fov_degrees) {
  // Relative to the distance at which the box's sphere touches the image's upper and lower edge.
  constexpr double kRoom = 1.05;
  Camera camera;
  camera.fov_degrees = fov_degrees;
  const glm::dvec3 centre = (to_glm(box.low) + to_glm(box.high)) * 0.5;
  const double radius = radius_of(box, centre);
  const glm::dvec3 u = glm::normalize(to_glm(up));
  const glm::dvec3 side = std::abs(u.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, -1, 0);
  const glm::dvec3 flat = glm::normalize(side - u * glm::dot(u, side));
  const glm::dvec3 from = glm::normalize(flat + 0.5 * glm::cross(u, flat) + 0.6 * u);
  camera.up = from_glm(u);
  camera.target = from_glm(centre);
  camera.eye = from_glm(centre + from * (kRoom * radius / std::sin(glm::radians(fov_degrees) / 2)));
  fit_planes(camera, box);
  return camera;
}

void fly(Camera& camera, const Vec3d& step, double yaw, double pitch) {
  const Axes a = axes_of(camera);
  const glm::dvec3 up = glm::normalize(to_glm(camera.up));
  const double height = std::asin(std::clamp(glm::dot(a.forward, up), -1.0, 1.0));
  const double limit = glm::radians(88.0);
  const double raised = std::clamp(height + glm::radians(pitch), -limit, limit);
  // Derived from the axis to the right, which exists even where the view is vertical.
  const glm::dvec3 flat = glm::cross(up, a.right);
  const double turn = glm::radians(-yaw);
  const glm::dvec3 ahead = flat * std::cos(turn) + glm::cross(up, flat) * std::sin(turn);
  const glm::dvec3 forward = ahead * std::cos(raised) + up * std::sin(raised);
  const glm::dvec3 eye = to_glm(camera.eye) + a.forward * step.x + a.right * step.y + up * step.z;
  const double reach = glm::length(to_glm(camera.target) - to_glm(camera.eye));
  camera.eye = from_glm(eye);
  camera.target = from_glm(eye + forward * reach);
}

}  // namespace atlas
