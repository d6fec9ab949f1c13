// Exact geometric predicates (CGAL's filtered kernel behind the .cpp): the sign is the sign of the
// true determinant of the doubles given, never a rounding error's.
#pragma once

#include "libatlas/core/vec.h"

namespace atlas {

// +1 if a, b, c turn left, -1 if right, 0 if collinear. Coordinates must be finite.
int orientation(Vec2d a, Vec2d b, Vec2d c);

// Whether the open segments ab and cd cross, or overlap along a stretch. Touching at a shared end
// point only does not count.
bool segments_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d);

}  // namespace atlas
