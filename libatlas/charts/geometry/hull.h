// Internal: distances, convex hulls and smallest rectangles of flat points.
#pragma once

#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Twice the signed area of the triangle o, a, b.
inline double cross(const Vec2d& o, const Vec2d& a, const Vec2d& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

double distance(const Vec2d& a, const Vec2d& b);

// From p to the segment from a to b. Squared: long outlines ask for it millions of times.
double squared_distance_to_segment(const Vec2d& p, const Vec2d& a, const Vec2d& b);

// Whether the inner points of two segments cross; touching ends are decided either way.
bool cross_each_other(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d);

// Area of the convex hull, whose corners go to `hull`, counter-clockwise; sorts `points`
// (Andrew 1979).
double hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull);

// The same of points that ascend by x and, where that is equal, y.
double sorted_hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull);

// What hull and smallest rectangle cover at most, from how far the points reach in sixteen
// directions: hardly more than they do for shapes that are not slim.
struct ShapeBounds {
  double hull = 0, box = 0;
};
ShapeBounds bound_shape(const std::vector<Vec2d>& points);

// Area of the smallest rectangle around a convex polygon: one side lies along an edge of it
// (Freeman and Shapira 1975). Quadratic, for some dozen corners.
double box_area(const std::vector<Vec2d>& hull);

}  // namespace atlas
