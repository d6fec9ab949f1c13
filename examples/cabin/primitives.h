// Shapes from which the cabin is built. All are in metres and provide analytic or finite-difference
// normals, so that refinement can follow the smooth surface.
#pragma once

#include <functional>

#include "examples/cabin/cabin_mesh.h"

namespace cabin {

using Warp = std::function<glm::dvec3(glm::dvec3)>;  // space to space, preserves orientation
using Surface = std::function<glm::dvec3(double u, double v)>;  // [0, 1]² to space

// A surface sampled with nu x nv quads. Its normal is dS/du x dS/dv, or the opposite if `flip`. uv
// is (u, v) times `tiles`.
struct GridShape {
  Surface surface;
  int nu = 1, nv = 1;
  glm::dvec2 tiles{1, 1};
  bool flip = false;
  std::function<glm::dvec2(glm::dvec3)> tiles_of;  // texture coordinates from the position, if set
};
void add_grid(Builder& builder, const GridShape& shape);

// A box with rounded edges, deformed by `warp` if set. uv is the distance in metres along the faces
// times tiles_per_metre.
struct RoundedBox {
  glm::dvec3 centre{0}, half{0.5};
  double radius = 0.05;
  double tiles_per_metre = 1;
  Warp warp;
  bool inward = false;   // normals point inwards, as in a closed room
  int corner_least = 1;  // least number of segments in an eighth of a circle
  // Least number of segments along the flat part of each axis; where triangles are scarce, a box of
  // 0 is a plain one.
  glm::ivec3 least{1};
};
void add_rounded_box(Builder& builder, const RoundedBox& box);

// A closed profile (superellipse, half sizes `half`, exponent 4) swept along a closed path in the
// xy plane: a rounded rectangle of half size `path_half` and corner radius `path_radius`.
struct Ring {
  glm::dvec2 path_half{0.5}, half{0.03, 0.01};
  double path_radius = 0.1;
  int least = 3;  // least number of segments of the path's long sides
  double tiles_per_metre = 1;
  Warp warp;  // from (path x, path y, height above the plane)
};
void add_ring(Builder& builder, const Ring& ring);

// A body of revolution about the vertical axis through `centre`. profile(t) is (radius, z), t in
// [0, 1].
struct Revolved {
  glm::dvec3 centre{0};
  std::function<glm::dvec2(double)> profile;
  double largest_radius = 0.1, height = 0.2;
};
void add_revolved(Builder& builder, const Revolved& body);

}  // namespace cabin
