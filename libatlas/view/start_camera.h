// Chooses where a visitor enters a scene.
#pragma once

#include "libatlas/core/context.h"
#include "libatlas/view/camera.h"
#include "libatlas/view/view_scene.h"

namespace atlas {

// Returns a camera where the scene's file says that a viewer begins (ViewScene::start), with
// `fov_degrees`. If it says nothing, returns one inside the scene if the scene surrounds a visitor,
// as where exported worlds begin (choose_viewpoint()), with a view of something lit if the scene
// shows light. Otherwise, and if `up` is the x axis, the camera looks at the whole scene from a
// little above its side. `up` must be an axis. If cancelled, returns any of these.
Camera start_camera(const ViewScene& scene, const Vec3d& up,
                    double fov_degrees = Camera{}.fov_degrees, const Context& context = {});

}  // namespace atlas
