#include "libatlas/view/start_camera.h"

#include "libatlas/exporters/viewpoint.h"

namespace atlas {

Camera start_camera(const ViewScene& scene, const Vec3d& up, double fov_degrees) {
  Camera camera = camera_for(scene.bounds, up, fov_degrees);
  if (up.x != 0 || scene.caster_indices.empty()) return camera;
  ViewpointOptions eye;
  eye.metres_per_unit = scene.metres_per_unit;
  eye.up = up.z != 0 ? Up::z : Up::y;
  const Viewpoint start =
      choose_viewpoint(scene.caster_positions, scene.caster_indices, eye, Context{});
  if (!start.inside) return camera;
  camera.eye = start.position;
  camera.target = {start.position.x + start.direction.x, start.position.y + start.direction.y,
                   start.position.z + start.direction.z};
  fit_planes(camera, scene.bounds);
  return camera;
}

}  // namespace atlas
