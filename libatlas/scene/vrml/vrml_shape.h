// Internal: what a Shape of a VRML97 file holds, before its faces become triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

struct VrmlShape {
  std::vector<Vec3d> points;
  std::vector<Vec2f> uvs;
  std::vector<Vec3f> colours;
  // Indices, with a -1 after each face; the latter two may be empty, and are then the first. Those
  // of colours of faces are one a face, without -1.
  std::vector<std::int32_t> corners, uv_corners, colour_corners;
  bool colour_per_vertex = true;  // false: one for each face
  std::uint32_t material = 0;
  bool clockwise = false;  // the order of a face's corners, seen from its front
  // Whether the file says so itself. TRUE is also the default, but many files do not say it of
  // faces that are to be seen from both sides, so these stay double-sided.
  bool solid = false;
};

// Gives a shape without texture coordinates those of the standard: the longest side of its box runs
// from u = 0 to 1, and the next longest along v in the same scale. Of equal sides, x comes before y
// and y before z.
void add_default_uvs(VrmlShape& shape);

// Turns the colours, which are given per vertex, corner or face, into one for each point: a point
// whose corners differ in colour becomes several. A component of a point without a colour is NaN.
void give_points_colours(VrmlShape& shape);

}  // namespace atlas
