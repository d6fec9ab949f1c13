// The orthographic view of a directional light over a scene: where each texel of its shadow map
// lies, kept steady while the camera moves.
#pragma once

#include <array>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

struct Box3 {
  Vec3d low, high;
};

// Column-major 4x4, as OpenGL takes it.
using Matrix4 = std::array<double, 16>;

struct LightFitOptions {
  int resolution = 2048;  // texels a side, >= 1
  Vec3d up{0, 1, 0};      // the map's vertical, unless it is zero, not finite or along the light
  bool snap = true;       // move the map in whole texels only: edges do not crawl with the camera
  double border_texels = 4;  // free texels around what is fitted, for filters that look beside it
  // The eight corners of the part of the view to cover; all zero (view == false): the whole scene.
  bool view = false;
  std::array<Vec3d, 8> view_corners{};
};

struct LightFit {
  // World to map: xy in [0, 1] texture coordinates, z in [0, 1] depth, growing away from the light.
  Matrix4 to_texture{};
  // World to clip space of the same map (xy and z in [-1, 1]).
  Matrix4 to_clip{};
  Vec3d direction;         // towards the light, unit length
  double texel = 0;        // world size of a texel
  double depth_range = 0;  // world distance between depth 0 and depth 1
};

// Fits the map of a light in `direction` (towards the light, not zero) to the scene's bounds, so
// that every caster and receiver in them is covered; with options.view only receivers in the view's
// bounding sphere are, their casters still being in the depth range. The side is the diameter of
// the sphere around what is fitted: it does not change when the light turns or the camera does, so
// texels keep their size. bad_option if the direction is zero, the box has a low above its high,
// either or a corner of the view is not finite, the box reaches beyond 1e150, or the border is
// negative or leaves no texel. A box of one point is fitted, too.
Result<LightFit> fit_light(const Vec3d& direction, const Box3& scene,
                           const LightFitOptions& options);

// The map's axes, unit vectors; `direction` must not be zero.
struct MapAxes {
  Vec3d x, y;
};
MapAxes map_axes(const Vec3d& direction, const Vec3d& up);

// p transformed by m (w is 1 for these matrices).
Vec3d transform_point(const Matrix4& m, const Vec3d& p);

// The same transform for points that are given relative to `origin`.
Matrix4 relative_to(const Matrix4& m, const Vec3d& origin);

// The direction's change of (u, v, depth) per world unit: transform without translation.
Vec3d transform_vector(const Matrix4& m, const Vec3d& v);

}  // namespace atlas
