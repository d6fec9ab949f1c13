#include "libatlas/raster/scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "tests/raster/random_triangles.h"

namespace atlas {
namespace {

using Hits = std::map<std::pair<int, int>, int>;

void scan_into(Hits& hits, const TexelTriangle& t, const Rect& clip, Vec2d offset) {
  scan_triangle(t, clip, offset, [&](int y, int x0, int x1) {
    ASSERT_LT(x0, x1);
    for (int x = x0; x < x1; ++x) ++hits[{x, y}];
  });
}

// Returns the sign of the exact area of (a, b, point) on the sub-texel grid.
int side(const std::int64_t a[2], const std::int64_t b[2], std::int64_t x, std::int64_t y) {
  const __int128 v = static_cast<__int128>(b[0] - a[0]) * (y - a[1]) -
                     static_cast<__int128>(b[1] - a[1]) * (x - a[0]);
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

// Coordinates have coarse steps, so that many points lie on edges and corners.
TEST(ScanTriangle, ClosedTrianglesHaveAllPointsOfTheirEdges) {
  constexpr int kBits = 1;
  const Rect clip{0, 0, 24, 24};
  int on_edges = 0;
  for (const TexelTriangle& t : random_triangles(3000, 2, 24)) {
    Hits hits;
    scan_triangle<kBits, EdgeRule::closed>(t, clip, {0.5, 0.5}, [&](int y, int x0, int x1) {
      for (int x = x0; x < x1; ++x) ++hits[{x, y}];
    });
    std::int64_t v[3][2];
    for (int k = 0; k < 3; ++k) {
      v[k][0] = std::llrint(2 * (t[k].x - 0.5));
      v[k][1] = std::llrint(2 * (t[k].y - 0.5));
    }
    const int turn = side(v[0], v[1], v[2][0], v[2][1]);
    for (int y = 0; y < clip.height; ++y)
      for (int x = 0; x < clip.width; ++x) {
        int inside = 1;
        for (int k = 0; k < 3; ++k)
          inside = std::min(inside, turn * side(v[k], v[(k + 1) % 3], 2 * x, 2 * y));
        on_edges += turn != 0 && inside == 0;
        const int hit = hits.count({x, y}) ? hits[{x, y}] : 0;
        ASSERT_EQ(hit, turn != 0 && inside >= 0) << x << ' ' << y;
      }
  }
  EXPECT_GT(on_edges, 1000);
}

TEST(ScanTriangle, AgreesWithPointByPointTestsOffTheEdges) {
  const Rect clip{0, 0, 24, 24};
  const Vec2d offset{0.375, 0.625};
  const double one = 1 << kSubTexelBits;
  for (const TexelTriangle& t : random_triangles(3000, 1, 24)) {
    Hits hits;
    scan_into(hits, t, clip, offset);
    std::int64_t v[3][2];
    for (int k = 0; k < 3; ++k) {
      v[k][0] = std::llrint((t[k].x - offset.x) * one);
      v[k][1] = std::llrint((t[k].y - offset.y) * one);
    }
    const int turn = side(v[0], v[1], v[2][0], v[2][1]);
    for (int y = 0; y < clip.height; ++y)
      for (int x = 0; x < clip.width; ++x) {
        const std::int64_t px = x * std::int64_t{1 << kSubTexelBits};
        const std::int64_t py = y * std::int64_t{1 << kSubTexelBits};
        int inside = 1;
        for (int k = 0; k < 3; ++k)
          inside = std::min(inside, turn * side(v[k], v[(k + 1) % 3], px, py));
        const int hit = hits.count({x, y}) ? hits[{x, y}] : 0;
        const bool outside = turn == 0 || inside < 0;
        ASSERT_GE(hit, turn != 0 && inside > 0) << x << ' ' << y;
        ASSERT_LE(hit, outside ? 0 : 1) << x << ' ' << y;
      }
  }
}

TEST(ScanTriangle, TrianglesThatShareEdgesOwnEachPointOnce) {
  // Fans around a hub; rim and hub may lie on sample points, too. Every point inside belongs to
  // exactly one triangle.
  const Rect clip{0, 0, 40, 40};
  std::mt19937 random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 3 + static_cast<int>(random() % 12);
    const bool on_grid = trial % 2 == 0;
    const auto snap = [&](double v) { return on_grid ? std::floor(v) + 0.5 : v; };
    const Vec2d hub{snap(20 + (random() % 100) * 0.01), snap(20 + (random() % 100) * 0.01)};
    std::vector<Vec2d> rim;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.3 * (random() % 100) * 0.01) / n;
      rim.push_back({snap(20 + 17 * std::cos(angle)), snap(20 + 17 * std::sin(angle))});
    }
    Hits fan, outline;
    for (int i = 0; i < n; ++i) {
      TexelTriangle t{hub, rim[i], rim[(i + 1) % n]};
      if (random() % 2) std::swap(t[1], t[2]);
      std::rotate(t.begin(), t.begin() + random() % 3, t.end());
      scan_into(fan, t, clip, {0.5, 0.5});
    }
    for (int i = 1; i + 1 < n; ++i)
      scan_into(outline, {rim[0], rim[i], rim[i + 1]}, clip, {0.5, 0.5});
    for (const auto& [at, count] : fan) ASSERT_EQ(count, 1) << at.first << ' ' << at.second;
    // If the rim is convex, another triangulation of it owns the same points.
    if (!on_grid) {
      ASSERT_EQ(fan, outline);
    }
  }
}

TEST(ScanTriangle, OwnsTheLeftAndTheTopEdgeOfASquare) {
  // The corners lie on sample points. Of the 5 x 5 points in the closed square, 4 x 4 are owned,
  // including the left column and the top row.
  const Vec2d a{2.5, 3.5}, b{6.5, 3.5}, c{6.5, 7.5}, d{2.5, 7.5};
  Hits hits;
  scan_into(hits, {a, b, c}, {0, 0, 16, 16}, {0.5, 0.5});
  scan_into(hits, {a, c, d}, {0, 0, 16, 16}, {0.5, 0.5});
  Hits want;
  for (int y = 4; y <= 7; ++y)
    for (int x = 2; x <= 5; ++x) want[{x, y}] = 1;
  EXPECT_EQ(hits, want);
}

TEST(ScanTriangle, IsTheSameForEveryCornerOrderAndForAnyClip) {
  for (const TexelTriangle& t : random_triangles(500, 3, 30)) {
    Hits first;
    scan_into(first, t, {0, 0, 30, 30}, {0.5, 0.5});
    for (const auto& order : {std::array{1, 2, 0}, std::array{0, 2, 1}, std::array{2, 1, 0}}) {
      Hits other;
      scan_into(other, {t[order[0]], t[order[1]], t[order[2]]}, {0, 0, 30, 30}, {0.5, 0.5});
      ASSERT_EQ(first, other);
    }
    Hits parts;
    for (const Rect& r : {Rect{0, 0, 13, 30}, Rect{13, 0, 17, 11}, Rect{13, 11, 17, 19}})
      scan_into(parts, t, r, {0.5, 0.5});
    ASSERT_EQ(first, parts);
  }
}

TEST(ScanTriangle, CountsThePointsOfAHugeTriangle) {
  // At 65536 texels per side, the products of the edge tests need the full 64 bits.
  const double n = 1 << 16;
  std::int64_t points = 0;
  scan_triangle({Vec2d{0, 0}, {n, 0}, {0, n}}, {0, 0, 1 << 16, 1 << 16}, {0.5, 0.5},
                [&](int, int x0, int x1) { points += x1 - x0; });
  // The diagonal passes through n centres. It is neither a left nor a top edge.
  EXPECT_EQ(points, (std::int64_t{1} << 31) - (1 << 15));
}

}  // namespace
}  // namespace atlas
