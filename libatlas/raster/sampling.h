// Sample points on a triangle, as many as its texels ask for: shifted grids on large triangles,
// quadrature points on small and thin ones, so that no triangle is missed between grid points.
// Header-only, so that the caller's work per sample is inlined.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "libatlas/raster/scan.h"

namespace atlas {

// K sample positions in the unit texel, K rounded up to a square and clamped to 64: a grid whose
// rows and columns are sheared so that no two positions share an x or a y (near-vertical and
// near-horizontal edges then get K coverage levels, not sqrt K). K = 1 is the texel's centre.
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

enum class SampleKind { none, points, split, grid };

namespace raster_detail {

inline double length2(Vec2d a, Vec2d b) {
  return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
}

struct Bary {
  float b[3];
};

inline Bary middle(const Bary& a, const Bary& b) {
  return {{0.5f * (a.b[0] + b.b[0]), 0.5f * (a.b[1] + b.b[1]), 0.5f * (a.b[2] + b.b[2])}};
}

// The rule with one point (centroid) or three (exact for quadratics).
template <class Point>
void quadrature(const Bary q[3], float area, bool three, Point&& point) {
  if (!three) {
    float c[3];
    for (int k = 0; k < 3; ++k) c[k] = (q[0].b[k] + q[1].b[k] + q[2].b[k]) * (1.0f / 3);
    point(c, area);
    return;
  }
  for (int i = 0; i < 3; ++i) {
    float c[3];
    for (int k = 0; k < 3; ++k)
      c[k] = (1.0f / 6) * (q[0].b[k] + q[1].b[k] + q[2].b[k]) + 0.5f * q[i].b[k];
    point(c, area * (1.0f / 3));
  }
}

// Bisects the longest edge until none is longer than the limit.
template <class Point>
void split(const TexelTriangle& p, const Bary q[3], float area, double limit2, bool three,
           Point&& point) {
  const double l[3] = {length2(p[1], p[2]), length2(p[2], p[0]), length2(p[0], p[1])};
  int e = 0;  // the corner opposite the longest edge
  for (int k = 1; k < 3; ++k)
    if (l[k] > l[e]) e = k;
  if (l[e] <= limit2) return quadrature(q, area, three, point);
  const int a = (e + 1) % 3, b = (e + 2) % 3;
  const Vec2d m{0.5 * (p[a].x + p[b].x), 0.5 * (p[a].y + p[b].y)};
  const Bary mb = middle(q[a], q[b]);
  const Bary left[3] = {q[e], q[a], mb}, right[3] = {q[e], mb, q[b]};
  split({p[e], p[a], m}, left, 0.5f * area, limit2, three, point);
  split({p[e], m, p[b]}, right, 0.5f * area, limit2, three, point);
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
  // Lower than 0.7 grid steps: whole stretches of it may lie between the grid's points.
  const double low = 0.7 / grid.side;
  if (area2 * area2 < low * low * longest2) return SampleKind::split;
  return SampleKind::grid;
}

// Visits weighted samples whose weights sum to about the triangle's area in texels; exactly so
// (up to rounding) where it is sampled by quadrature.
//   row(k, y, x0, x1): grid samples (x + grid.offset[k].x, y + grid.offset[k].y), x0 <= x < x1,
//   each
//     of weight 1 / grid.count, clipped to `clip`;
//   point(bary, weight): one sample by its barycentric coordinates, float[3].
template <class Row, class Point>
void sample_triangle(const TexelTriangle& p, const Rect& clip, const SampleGrid& grid, Row&& row,
                     Point&& point) {
  using namespace raster_detail;
  const SampleKind kind = sample_kind(p, grid);
  if (kind == SampleKind::none) return;
  if (kind == SampleKind::grid) {
    for (int k = 0; k < grid.count; ++k)
      scan_triangle(p, clip, grid.offset[k], [&](int y, int x0, int x1) { row(k, y, x0, x1); });
    return;
  }
  const Bary corners[3] = {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  const float area = static_cast<float>(0.5 * std::fabs(cross_area(p)));
  const double limit = grid.side == 1 ? 1.0 : 2.0 / grid.side;
  // Far below a texel one point says it all.
  const bool three = grid.side > 1 && area > 0.02f / static_cast<float>(grid.count);
  split(p, corners, area, limit * limit, three, point);
}

}  // namespace atlas
