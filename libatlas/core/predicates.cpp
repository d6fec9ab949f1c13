#include "libatlas/core/predicates.h"

// CGAL checks the rounding modes at start-up. That check ends the program under valgrind, which can
// only round to nearest, but is still needed to count instructions. Instead, tests/core compares
// the predicates with exact arithmetic, which tests what the check guards.
#define CGAL_DISABLE_ROUNDING_MATH_CHECK
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>

namespace atlas {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_2 point(Vec2d p) {
  return {p.x, p.y};
}

// Returns whether p lies strictly between a and b. The three must be collinear.
bool strictly_between(Vec2d a, Vec2d b, Vec2d p) {
  if (a.x != b.x) return std::min(a.x, b.x) < p.x && p.x < std::max(a.x, b.x);
  return std::min(a.y, b.y) < p.y && p.y < std::max(a.y, b.y);
}

// Returns whether the segments ab and bc, neighbours on a border, overlap along a stretch.
bool fold_back(Vec2d a, Vec2d b, Vec2d c) {
  if (orientation(a, b, c) != 0) return false;
  return strictly_between(a, b, c) || strictly_between(b, c, a) || (a == c && !(a == b));
}

}  // namespace

int close_orientation(Vec2d a, Vec2d b, Vec2d c) {
  // Neighbouring edges share a point, and if two of the three points are equal, the bound in
  // orientation() never decides.
  if (a == b || b == c || a == c) return 0;
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c)));
}

bool near_segments_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d) {
  if (b == c) return fold_back(a, b, d);
  if (a == d) return fold_back(c, a, b);
  if (a == c) return fold_back(b, a, d);
  if (b == d) return fold_back(a, b, c);
  const int c_side = orientation(a, b, c), d_side = orientation(a, b, d);
  const int a_side = orientation(c, d, a), b_side = orientation(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  if (c_side == 0 && strictly_between(a, b, c)) return true;
  if (d_side == 0 && strictly_between(a, b, d)) return true;
  if (a_side == 0 && strictly_between(c, d, a)) return true;
  return b_side == 0 && strictly_between(c, d, b);
}

}  // namespace atlas
