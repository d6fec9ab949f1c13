// Internal: exact geometric predicates. The sign is that of the true determinant of the given
// doubles, unaffected by rounding errors, underflow or overflow: where rounding may decide, the
// determinant is summed up exactly, as an expansion of doubles if coordinates are between 2^-400
// and 2^500 or 0, and else in fixed point.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/core/vec.h"

namespace atlas {

// Decides the cases in which rounding may change the sign. For orientation() only.
int close_orientation(Vec2d a, Vec2d b, Vec2d c);

// Returns +1 if a, b, c turn left, -1 if they turn right, 0 if they are collinear. Coordinates must
// be finite.
inline int orientation(Vec2d a, Vec2d b, Vec2d c) {
  // Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast robust geometric
  // predicates", section 4.1: beyond this bound rounding cannot have changed the sign. It presumes
  // that no product underflowed, hence the second condition.
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  const double determinant = left - right, size = std::abs(left) + std::abs(right);
  if (std::abs(determinant) > 3.4e-16 * size && size > 1e-280) return determinant > 0 ? 1 : -1;
  return close_orientation(a, b, c);
}

// Decides the cases in which the segments' bounding boxes meet. For segments_cross() only.
bool near_segments_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d);

// Returns whether the segments ab and cd cross, overlap along a stretch, or touch because an end
// point of one lies inside the other. Segments that only share an end point do not count.
inline bool segments_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d) {
  const bool apart =
      std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
      std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y);
  return !apart && near_segments_cross(a, b, c, d);
}

}  // namespace atlas
