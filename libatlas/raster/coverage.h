// Internal: exact area coverage. Finds every texel that a triangle touches, and which part of the
// texel the triangle covers. Header-only, so that the caller's work per texel is inlined.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/raster/scan.h"

namespace atlas {

namespace raster_detail {

// A convex polygon. It has at most the three corners of a triangle and one more for each of the
// four sides of a texel that cut it.
struct Polygon {
  int n = 0;
  Vec2d p[8];
};

// Splits a convex polygon at a vertical (axis 0) or horizontal (axis 1) line into the parts below
// and above the coordinate.
template <int axis>
void cut(const Polygon& in, double at, Polygon& below, Polygon& above) {
  const auto coordinate = [](const Vec2d& v) { return axis == 0 ? v.x : v.y; };
  below.n = above.n = 0;
  for (int i = 0; i < in.n; ++i) {
    const Vec2d a = in.p[i], b = in.p[i + 1 == in.n ? 0 : i + 1];
    const double da = coordinate(a) - at, db = coordinate(b) - at;
    if (da <= 0) below.p[below.n++] = a;
    if (da >= 0) above.p[above.n++] = a;
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const double t = da / (da - db);
      const Vec2d c =
          axis == 0 ? Vec2d{at, a.y + t * (b.y - a.y)} : Vec2d{a.x + t * (b.x - a.x), at};
      below.p[below.n++] = c;
      above.p[above.n++] = c;
    }
  }
}

// The area of a polygon (positive for either orientation) and its centroid.
struct AreaMoments {
  double area = 0;
  Vec2d centroid;
};

inline AreaMoments moments(const Polygon& q) {
  AreaMoments m;
  double area2 = 0, sx = 0, sy = 0;
  const Vec2d o = q.p[0];
  for (int i = 1; i + 1 < q.n; ++i) {
    const double ax = q.p[i].x - o.x, ay = q.p[i].y - o.y;
    const double bx = q.p[i + 1].x - o.x, by = q.p[i + 1].y - o.y;
    const double c = ax * by - ay * bx;
    area2 += c;
    sx += c * (ax + bx);
    sy += c * (ay + by);
  }
  if (area2 == 0) return m;
  m.area = 0.5 * std::fabs(area2);
  m.centroid = {o.x + sx / (3 * area2), o.y + sy / (3 * area2)};
  return m;
}

inline void bounds(const Polygon& q, int axis, double& lo, double& hi) {
  lo = hi = axis == 0 ? q.p[0].x : q.p[0].y;
  for (int i = 1; i < q.n; ++i) {
    const double c = axis == 0 ? q.p[i].x : q.p[i].y;
    lo = std::min(lo, c);
    hi = std::max(hi, c);
  }
}

// Sets `lo` and `hi` to the x at which the polygon's horizontal edge or corner at height y begins
// and ends. Returns false if the polygon has no corner at that height.
inline bool chord(const Polygon& q, double y, double& lo, double& hi) {
  bool any = false;
  for (int i = 0; i < q.n; ++i) {
    const Vec2d a = q.p[i], b = q.p[i + 1 == q.n ? 0 : i + 1];
    if (a.y != y) continue;
    if (!any) lo = hi = a.x;
    any = true;
    lo = std::min(lo, a.x);
    hi = std::max(hi, a.x);
    if (b.y == y) lo = std::min(lo, b.x), hi = std::max(hi, b.x);
  }
  return any;
}

// Visits the texels of one row. `strip` is the part of the triangle between y and y + 1.
template <class Texel>
void cover_row(Polygon strip, int y, const Rect& clip, Texel&& texel) {
  double lo, hi, l0, h0, l1, h1;
  bounds(strip, 0, lo, hi);
  int x = std::max(static_cast<int>(std::floor(lo)), clip.x);
  const int end = std::min(static_cast<int>(std::ceil(hi)), clip.right());
  // A texel between the chords at the row's lower and upper side is covered completely, because the
  // triangle is convex.
  int full_begin = end, full_end = end;
  if (chord(strip, y, l0, h0) && chord(strip, y + 1, l1, h1)) {
    const int a = static_cast<int>(std::ceil(std::max(l0, l1)));
    const int b = static_cast<int>(std::floor(std::min(h0, h1)));
    if (a < b) full_begin = std::max(a, clip.x), full_end = std::min(b, end);
  }
  Polygon part, rest;
  if (x > lo) {  // the strip begins left of the clip rectangle
    cut<0>(strip, x, part, rest);
    strip = rest;
  }
  while (x < end && strip.n >= 3) {
    if (x == full_begin && full_begin < full_end) {
      for (; x < full_end; ++x) texel(x, y, 1.0, Vec2d{x + 0.5, y + 0.5});
      cut<0>(strip, x, part, rest);
      strip = rest;
      continue;
    }
    cut<0>(strip, x + 1.0, part, rest);
    const AreaMoments m = part.n >= 3 ? moments(part) : AreaMoments{};
    if (m.area > 0) texel(x, y, m.area, m.centroid);
    strip = rest;
    ++x;
  }
}

}  // namespace raster_detail

// Calls texel(x, y, area, centroid) for each texel of `clip` that shares area with the triangle,
// which may have either orientation. `area` is the shared area in (0, 1], and `centroid` its
// centroid in texels. The areas sum to the triangle's area within rounding. Coordinates must be
// finite and within kMaxTexelCoordinate.
template <class Texel>
void cover_triangle(const TexelTriangle& p, const Rect& clip, Texel&& texel) {
  using namespace raster_detail;
  Polygon rest, part, next;
  rest.n = 3;
  for (int k = 0; k < 3; ++k) rest.p[k] = p[k];
  double lo, hi, left, right;
  bounds(rest, 1, lo, hi);
  bounds(rest, 0, left, right);
  int y = static_cast<int>(std::floor(lo));
  const int x = static_cast<int>(std::floor(left));
  if (hi <= y + 1 && right <= x + 1) {  // inside one texel, as most triangles of a fine mesh are
    if (x < clip.x || x >= clip.right() || y < clip.y || y >= clip.top()) return;
    const AreaMoments m = moments(rest);
    if (m.area > 0) texel(x, y, m.area, m.centroid);
    return;
  }
  if (y < clip.y) {
    y = clip.y;
    if (hi <= y) return;
    cut<1>(rest, y, part, next);
    rest = next;
  }
  for (; y < hi && y < clip.top() && rest.n >= 3; ++y) {
    cut<1>(rest, y + 1.0, part, next);
    if (part.n >= 3) cover_row(part, y, clip, texel);
    rest = next;
  }
}

}  // namespace atlas
