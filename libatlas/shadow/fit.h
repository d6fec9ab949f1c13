// The orthographic view of a directional light over a scene. It determines where each texel of the
// light's shadow map lies, and keeps the texels steady while the camera moves.
#pragma once

#include <array>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

struct Box3 {
  Vec3d low = {}, high = {};
};

// A column-major 4x4 matrix, as OpenGL takes it.
using Matrix4 = std::array<double, 16>;

struct LightFitOptions {
  int resolution = 2048;     // texels a side, >= 1
  Vec3d up{0, 1, 0};         // the map's vertical, unless it is zero, not finite or along the light
  bool snap = true;          // move the map by whole texels: edges do not crawl with the camera
  double border_texels = 4;  // free texels around the fitted part, for filters that look beside it
  // If `view` is true, the map covers the part of the view with these eight corners. Otherwise, and
  // if that part is a point or larger than the scene, it covers the whole scene.
  bool view = false;
  std::array<Vec3d, 8> view_corners{};
};

struct LightFit {
  // Maps world positions to the shadow map: xy are texture coordinates in [0, 1], and z is the
  // depth in [0, 1], which grows away from the light.
  Matrix4 to_texture{};
  // Maps world positions to the clip space of the same map (xy and z in [-1, 1]).
  Matrix4 to_clip{};
  Vec3d direction = {};    // towards the light, unit length
  double texel = 0;        // world size of a texel
  double depth_range = 0;  // world distance between depth 0 and depth 1
};

// Fits the map of a light to the scene's bounds, so that the map covers every caster and receiver
// in them. `direction` points towards the light. With options.view the map covers only receivers in
// the view's bounding sphere; their casters are still in the depth range. The map's side is the
// diameter of the sphere around the fitted part. The side does not change when the light or the
// camera turns, so texels keep their size. A box of one point is fitted, too. Error: bad_option if
// the direction is zero or not finite, if the box has a low above its high, if the box or a corner
// of the view is not finite, if the box reaches beyond 1e150, or if the border is negative or
// leaves no texel.
Result<LightFit> fit_light(const Vec3d& direction, const Box3& scene,
                           const LightFitOptions& options);

// The map's axes in the world, as unit vectors. `direction` must not be zero.
struct MapAxes {
  Vec3d x = {}, y = {};
};
MapAxes map_axes(const Vec3d& direction, const Vec3d& up);

// Returns p transformed by m (w is 1 for these matrices).
Vec3d transform_point(const Matrix4& m, const Vec3d& p);

// Returns the same transform for points that are given relative to `origin`.
Matrix4 relative_to(const Matrix4& m, const Vec3d& origin);

// Returns v transformed without the translation: the change of (u, v, depth) along v.
Vec3d transform_vector(const Matrix4& m, const Vec3d& v);

}  // namespace atlas
