// Internal: distances, convex hulls and smallest rectangles of flat points.
#pragma once

#include <algorithm>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Twice the signed area of the triangle o, a, b.
inline double cross(const Vec2d& o, const Vec2d& a, const Vec2d& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

double distance(const Vec2d& a, const Vec2d& b);

// Returns the squared distance from p to the segment from a to b. Squared, since long outlines need
// it millions of times.
double squared_distance_to_segment(const Vec2d& p, const Vec2d& a, const Vec2d& b);

// Whether the interiors of two segments cross. If only ends touch, the result may be either.
bool cross_each_other(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d);

// Stores the corners of the convex hull in `hull`, counter-clockwise (Andrew 1979). The points must
// be sorted by x and, where that is equal, by y, and may be derived from Vec2d. Fewer than two have
// no corners. Corners that are collinear but for rounding may be kept or left out.
template <typename Point>
void sorted_hull(std::vector<Point>& points, std::vector<Point>& hull) {
  hull.clear();
  if (points.empty()) return;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    const Vec2d first = points.front(), last = points.back();
    for (const Point& p : points) {
      if (cross(first, last, p) > 0) continue;  // on the other pass's side
      while (hull.size() >= base + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
}

// Returns the area of the convex hull, and stores its corners in `hull` as above. Sorts `points`.
double hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull);

// The same for points that are sorted as above.
double sorted_hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull);

// Upper bounds on the areas of the convex hull and of the smallest rectangle, from the extents of
// the points in sixteen directions. They are close unless the shape is slim.
struct ShapeBounds {
  double hull = 0, box = 0;
};
ShapeBounds bound_shape(const std::vector<Vec2d>& points);

// Returns the area of the smallest rectangle around a convex polygon, one side of which lies along
// an edge of the polygon (Freeman and Shapira 1975). Linear, by rotating calipers (Toussaint 1983).
double box_area(const std::vector<Vec2d>& hull);

}  // namespace atlas
