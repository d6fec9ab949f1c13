#include "libatlas/charts/hull.h"

#include <algorithm>

namespace atlas {

bool cross_each_other(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
  if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
      std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y)) {
    return false;
  }
  return (cross(a, b, c) > 0) != (cross(a, b, d) > 0) &&
         (cross(c, d, a) > 0) != (cross(c, d, b) > 0);
}

double hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull) {
  std::sort(points.begin(), points.end(),
            [](const Vec2d& a, const Vec2d& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  return sorted_hull_area(points, hull);
}

double sorted_hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull) {
  hull.clear();
  if (points.empty()) return 0;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    const Vec2d first = points.front(), last = points.back();
    for (const Vec2d& p : points) {
      if (cross(first, last, p) > 0) continue;  // it lies on the other pass's side
      while (hull.size() >= base + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  double twice = 0;
  for (std::size_t i = 2; i < hull.size(); ++i) twice += cross(hull[0], hull[i - 1], hull[i]);
  return 0.5 * twice;
}

double box_area(const std::vector<Vec2d>& hull) {
  double smallest = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
    if (!(length2 > 0)) continue;
    double low = 0, high = 0, far = 0;
    for (const Vec2d& p : hull) {
      const double along = (p.x - a.x) * dx + (p.y - a.y) * dy;
      low = std::min(low, along);
      high = std::max(high, along);
      far = std::max(far, (p.y - a.y) * dx - (p.x - a.x) * dy);
    }
    const double area = (high - low) * far / length2;
    if (smallest == 0 || area < smallest) smallest = area;
  }
  return smallest;
}

}  // namespace atlas
