// Internal: sample points on a triangle, in a number that suits the texels it covers. Large
// triangles are sampled by shifted grids. Small and thin triangles are sampled by quadrature
// points, because they could lie between the grid points and be missed. Header-only, so that the
// caller's work per sample is inlined.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/raster/scan.h"

namespace atlas {

// K sample positions in the unit texel. K is rounded up to a square and is at most 64. The
// positions form a grid whose rows and columns are sheared so that no two positions share an x or a
// y. Near-vertical and near-horizontal edges therefore get K coverage levels and not sqrt K. With K
// = 1 the only position is the texel's centre.
struct SampleGrid {
  int count = 1;
  int side = 1;
  Vec2d offset[64];

  explicit SampleGrid(int shifts);
};

// Twice the signed area.
inline double cross_area(const TexelTriangle& p) {
  return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
}

enum class SampleKind { none, points, thin, grid };

namespace raster_detail {

inline double length2(Vec2d a, Vec2d b) {
  return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
}

// Visits the points of a quadrature rule: one point (the centroid), or three points, which are
// exact for quadratic functions.
template <class Point>
void quadrature(float area, bool three, Point&& point) {
  if (!three) {
    const float c[3] = {1.0f / 3, 1.0f / 3, 1.0f / 3};
    point(c, area);
    return;
  }
  for (int i = 0; i < 3; ++i) {
    float c[3] = {1.0f / 6, 1.0f / 6, 1.0f / 6};
    c[i] += 0.5f;
    point(c, area * (1.0f / 3));
  }
}

// Cuts a thin triangle across its longest edge into slices of about the width `step`, and visits
// the centroid of each slice with the slice's area.
template <class Point>
void slices(const TexelTriangle& p, float area, double step, Point&& point) {
  const double l[3] = {length2(p[1], p[2]), length2(p[2], p[0]), length2(p[0], p[1])};
  int e = 0;  // the corner opposite the longest edge
  for (int k = 1; k < 3; ++k)
    if (l[k] > l[e]) e = k;
  const int ends[2] = {(e + 1) % 3, (e + 2) % 3};
  const Vec2d a = p[ends[0]], b = p[ends[1]];
  // The position on the longest edge, from 0 to 1, of the foot of the altitude from corner e. The
  // parts of the triangle on both sides of that altitude taper to the ends of the edge.
  const double foot =
      std::clamp(((p[e].x - a.x) * (b.x - a.x) + (p[e].y - a.y) * (b.y - a.y)) / l[e], 0.0, 1.0);
  for (int k = 0; k < 2; ++k) {
    const double share = k == 0 ? foot : 1 - foot;
    if (!(share > 0)) continue;
    const int n = static_cast<int>(std::ceil(share * std::sqrt(l[e]) / step));
    // The middle of the altitude, in barycentric coordinates.
    double middle[3];
    middle[e] = 0.5;
    middle[ends[0]] = 0.5 * (1 - foot);
    middle[ends[1]] = 0.5 * foot;
    for (int i = 0; i < n; ++i) {
      // Slice i counted from the tip. The area up to the end of slice i grows as the square of its
      // number, and the first moment as the cube.
      const double squares = 2.0 * i + 1, cubes = 3.0 * i * i + 3.0 * i + 1;
      const double f = 2.0 / 3 * cubes / (squares * n);
      float c[3];
      for (int j = 0; j < 3; ++j)
        c[j] = static_cast<float>(f * middle[j] + (j == ends[k] ? 1 - f : 0));
      point(c, static_cast<float>(area * share * squares / (double(n) * n)));
    }
  }
}

}  // namespace raster_detail

// How sample_triangle treats a triangle.
inline SampleKind sample_kind(const TexelTriangle& p, const SampleGrid& grid) {
  using namespace raster_detail;
  const double area2 = std::fabs(cross_area(p));
  if (!(area2 > 0)) return SampleKind::none;
  const double longest2 = std::max({length2(p[0], p[1]), length2(p[1], p[2]), length2(p[2], p[0])});
  const double limit = grid.side == 1 ? 1.0 : 2.0 / grid.side;
  if (longest2 <= limit * limit) return SampleKind::points;
  // If the triangle's height is below 0.7 grid steps, whole stretches of it may lie between the
  // grid's points.
  const double low = 0.7 / grid.side;
  if (area2 * area2 < low * low * longest2) return SampleKind::thin;
  return SampleKind::grid;
}

// The two functions that receive a triangle's weighted samples.
template <class Row, class Point>
struct SampleVisitor {
  // row(k, y, x0, x1) receives the grid samples (x + grid.offset[k].x, y + grid.offset[k].y) with
  // x0 <= x < x1. Each has the weight 1 / grid.count, and all lie inside the clip rectangle.
  Row row;
  // point(bary, weight) receives one sample by its barycentric coordinates, float[3]. These samples
  // are not clipped.
  Point point;
};
template <class Row, class Point>
SampleVisitor(Row, Point) -> SampleVisitor<Row, Point>;

// Visits weighted samples of a triangle. The weights sum to about the triangle's area in texels,
// and to exactly that area (up to rounding) if the triangle is sampled by quadrature or in slices.
template <class Row, class Point>
void sample_triangle(const TexelTriangle& p, const Rect& clip, const SampleGrid& grid,
                     SampleVisitor<Row, Point> visit) {
  using namespace raster_detail;
  const SampleKind kind = sample_kind(p, grid);
  if (kind == SampleKind::none) return;
  const auto area = static_cast<float>(0.5 * std::fabs(cross_area(p)));
  if (kind == SampleKind::thin) {
    slices(p, area, grid.side == 1 ? 1.0 : 2.0 / grid.side, visit.point);
    return;
  }
  if (kind == SampleKind::grid) {
    bool any = false;
    for (int k = 0; k < grid.count; ++k)
      scan_triangle(p, clip, grid.offset[k], [&](int y, int x0, int x1) {
        any = true;
        visit.row(k, y, x0, x1);
      });
    if (any) return;  // otherwise the triangle lies between the grid's points or outside the clip
  }
  // One point is enough for a triangle far smaller than a texel.
  const bool three = grid.side > 1 && area > 0.02f / static_cast<float>(grid.count);
  quadrature(area, three, visit.point);
}

}  // namespace atlas
