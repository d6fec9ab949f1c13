// Where a visitor enters a scene.
#pragma once

#include "libatlas/view/camera.h"
#include "libatlas/view/view_scene.h"

namespace atlas {

// Inside, where the scene surrounds a visitor, as exported worlds begin (choose_viewpoint()); else
// a little above its side, looking at the whole, as where `up` is the x axis. `up` is an axis.
Camera start_camera(const ViewScene& scene, const Vec3d& up,
                    double fov_degrees = Camera{}.fov_degrees);

}  // namespace atlas
