// Makes scenes and a context for the tests of the view.
#pragma once

#include <memory>

#include "libatlas/scene/scene.h"
#include "libatlas/view/camera.h"
#include "libatlas/view/context.h"
#include "libatlas/view/renderer.h"

namespace atlas::testing {

// These append to a scene with one white material. Nothing is welded.
void add_quad(Scene& scene, const Vec3f (&corners)[4], int cuts = 1);
void add_box(Scene& scene, const Vec3f& low, const Vec3f& high);
void add_sphere(Scene& scene, const Vec3f& centre, float radius, int cuts);

// A floor of 10 x 10 at y = 0 with boxes, poles and a sphere on and above it.
Scene courtyard();
// A room with a window and a doorway, some furniture, seen from inside.
Scene room();
// A slanted roof on thin posts over rolling ground.
Scene pavilion();

struct View {
  Scene scene;
  Camera camera;
};
View courtyard_view();
View room_view();
View pavilion_view();

// The debug context that tests draw with, of the software renderer, or of a GPU if the environment
// has LIBATLAS_GPU. There is one per process, since making contexts is slow.
GlContext& test_context();

// Returns a renderer, and fails the test if it cannot be made.
Renderer must_render(const Scene& scene, const RenderOptions& options);

// Returns a frame's light that does not move.
FrameLight still(const Vec3d& direction);

// Returns a value of 0 to 1 in sRGB encoding, 0 to 255.
double encoded(double value);

}  // namespace atlas::testing
