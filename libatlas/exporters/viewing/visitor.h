// Internal: the visitor for whom a world is shown, and how near to the eye it must be drawn.
#pragma once

#include "libatlas/exporters/world.h"

namespace atlas {

// Lengths are in scene units.
struct Visitor {
  double width = 0;      // > 0; what stays free on every side
  double height = 0;     // > 0; of the eyes above the floor
  double step = 0;       // > 0; the highest thing that is stepped over
  double speed = 0;      // > 0; a second
  bool outside = false;  // whether the viewpoint is outside the box of all triangles
  double farthest = 0;   // from the viewpoint to a corner of a triangle; 0 without triangles
  // Distance of the near plane that VRML recommends.
  double near_plane() const { return width / 2; }
};

// Chooses a visitor for the world's viewpoint. Within the box of all triangles that is a person
// (0.25 m wide, eyes at 1.6 m, 0.75 m, 1.5 m/s), but with eyes no higher above the floor than the
// viewpoint is, and no wider than half the distance to the nearest triangle. From outside, it is a
// person scaled to a width of a fiftieth of the distance to the box: a near plane at half of that
// lies well before the box, yet far enough from the eye for the depth buffers of viewers, which
// hold 24 bits. Precondition: check_world() has accepted the world.
Visitor visitor_of(const World& world);

}  // namespace atlas
