#include "libatlas/core/hull.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/portable_math.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/core/wide_vectors.h"

namespace atlas {

double distance(const Vec2d& a, const Vec2d& b) {
  return portable::hypot(b.x - a.x, b.y - a.y);
}

double squared_distance_to_segment(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double along =
      length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0;
  const double x = p.x - a.x - along * dx, y = p.y - a.y - along * dy;
  return x * x + y * y;
}

bool cross_each_other(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& d) {
  if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
      std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y)) {
    return false;
  }
  return (cross(a, b, c) > 0) != (cross(a, b, d) > 0) &&
         (cross(c, d, a) > 0) != (cross(c, d, b) > 0);
}

double hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull) {
  sort_total(points.begin(), points.end(),
             [](const Vec2d& a, const Vec2d& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  return sorted_hull_area(points, hull);
}

double sorted_hull_area(std::vector<Vec2d>& points, std::vector<Vec2d>& hull) {
  sorted_hull(points, hull);
  double twice = 0;
  for (std::size_t i = 2; i < hull.size(); ++i) twice += cross(hull[0], hull[i - 1], hull[i]);
  return 0.5 * twice;
}

namespace {

// Directions in steps of a sixteenth of a turn: four in the first quadrant, four in the second.
constexpr double kStepCosine = 0.92387953251128674, kStepSine = 0.38268343236508977;
constexpr double kDiagonal = 0.70710678118654752;
// Relative rounding error of areas.
constexpr double kRounding = 1e-9;

// How far the points reach in eight directions (`most`) and, negatively, in the opposite ones
// (`least`).
struct Reach {
  Quad most[2], least[2];
};
ATLAS_INLINE void find_reach(const std::vector<Vec2d>& points, Reach& reach) {
  const Quad cosines{1, kStepCosine, kDiagonal, kStepSine},
      sines{0, kStepSine, kDiagonal, kStepCosine};
  Quad most0{}, least0{}, most1{}, least1{};
  const Vec2d origin = points.front();
  for (const Vec2d& p : points) {
    const double x = p.x - origin.x, y = p.y - origin.y;
    const Quad first = x * cosines + y * sines, second = y * cosines - x * sines;
    most0 = first > most0 ? first : most0;
    least0 = first < least0 ? first : least0;
    most1 = second > most1 ? second : most1;
    least1 = second < least1 ? second : least1;
  }
  reach = {{most0, most1}, {least0, least1}};
}
ATLAS_WIDE void find_reach_wide(const std::vector<Vec2d>& points, Reach& reach) {
  find_reach(points, reach);
}
void find_reach_narrow(const std::vector<Vec2d>& points, Reach& reach) {
  find_reach(points, reach);
}

}  // namespace

ShapeBounds bound_shape(const std::vector<Vec2d>& points) {
  if (points.empty()) return {};
  Reach reach;
  (has_wide_vectors ? find_reach_wide : find_reach_narrow)(points, reach);
  double support[18];  // all around, with the last direction also first, and the first also last
  for (int k = 0; k < 4; ++k) {
    support[1 + k] = reach.most[0][k];
    support[5 + k] = reach.most[1][k];
    support[9 + k] = -reach.least[0][k];
    support[13 + k] = -reach.least[1][k];
  }
  support[0] = support[16];
  support[17] = support[1];
  // Of the polygon that sixteen tangents bound: each distance from the origin times its side's
  // length.
  double twice = 0;
  for (int k = 1; k <= 16; ++k) {
    twice += support[k] * (support[k - 1] + support[k + 1] - 2 * kStepCosine * support[k]);
  }
  ShapeBounds bounds;
  bounds.hull = (1 + kRounding) * twice / (2 * kStepSine);
  for (int k = 1; k <= 4; ++k) {
    const double box = (support[k] + support[k + 8]) * (support[k + 4] + support[k + 12]);
    if (k == 1 || box < bounds.box) bounds.box = box;
  }
  bounds.box *= 1 + kRounding;
  return bounds;
}

namespace {

// Returns the corner at which `value` is highest, walking around the convex polygon from a corner
// before it.
template <typename Value>
std::size_t highest(const std::vector<Vec2d>& hull, std::size_t from, const Value& value) {
  double most = value(hull[from]);
  for (std::size_t step = 1; step < hull.size(); ++step) {
    const std::size_t next = from + 1 < hull.size() ? from + 1 : 0;
    const double there = value(hull[next]);
    if (!(there >= most)) break;
    most = there;
    from = next;
  }
  return from;
}

}  // namespace

double box_area(const std::vector<Vec2d>& hull) {
  double smallest = 0;
  // The corners that touch the other three sides move forward only, as the edge does.
  std::size_t right = hull.size(), top = right, left = right;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d &a = hull[i], &b = hull[i + 1 < hull.size() ? i + 1 : 0];
    const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
    if (!(length2 > 0)) continue;
    const auto along = [&](const Vec2d& p) { return (p.x - a.x) * dx + (p.y - a.y) * dy; };
    const auto back = [&](const Vec2d& p) { return -along(p); };
    const auto above = [&](const Vec2d& p) { return (p.y - a.y) * dx - (p.x - a.x) * dy; };
    right = highest(hull, right < hull.size() ? right : i, along);
    top = highest(hull, top < hull.size() ? top : right, above);
    left = highest(hull, left < hull.size() ? left : top, back);
    const double high = std::max(0.0, along(hull[right])), low = std::min(0.0, along(hull[left])),
                 far = std::max(0.0, above(hull[top]));
    const double area = (high - low) * far / length2;
    if (smallest == 0 || area < smallest) smallest = area;
  }
  return smallest;
}

}  // namespace atlas
