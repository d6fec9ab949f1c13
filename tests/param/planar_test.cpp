#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "libatlas/param/descent/planar.h"
#include "libatlas/param/distortion.h"
#include "libatlas/param/orient.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

Disc hills(unsigned seed, double height) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  const double a = 3 + 4 * u(random), b = 3 + 4 * u(random), c = 6 * u(random);
  return testing::make_grid(24, 17, [=](double x, double y) {
    return Vec3d{x, y, height * std::sin(a * x + c) * std::cos(b * y)};
  });
}

TEST(Planar, BoundIsNeverExceeded) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Disc d = hills(seed, 0.02 * (1 + seed % 10));
    const Vec3d axis = mean_normal(d.view());
    std::vector<Vec2d> uv(d.positions.size());
    project_planar(d.view(), axis, uv);
    const double bound = planar_stretch_bound(d.view(), axis);
    ASSERT_TRUE(std::isfinite(bound));
    const Distortion m = measure_distortion(d.view(), uv);
    EXPECT_EQ(m.flips, 0u);
    EXPECT_LE(m.stretch_linf, bound * (1 + 1e-6));
    std::vector<TriangleStretch> s(d.triangles.size());
    measure_triangles(d.view(), uv, s);
    for (const TriangleStretch& t : s) {
      EXPECT_LE(t.s1, bound * (1 + 1e-6));
      EXPECT_NEAR(t.s2, 1, 1e-5);
    }
  }
}

TEST(Planar, FlipsExactlyTheTrianglesThatLookAway) {
  const Disc d = hills(3, 0.5);
  const Vec3d axis{0.3, 0.9, 0.2};
  std::vector<Vec2d> uv(d.positions.size());
  project_planar(d.view(), axis, uv);
  std::uint64_t away = 0;
  for (const auto& t : d.triangles) {
    const Vec3d p = d.positions[t[0]], q = d.positions[t[1]], r = d.positions[t[2]];
    const Vec3d e{q.x - p.x, q.y - p.y, q.z - p.z}, f{r.x - p.x, r.y - p.y, r.z - p.z};
    away += axis.x * (e.y * f.z - e.z * f.y) + axis.y * (e.z * f.x - e.x * f.z) +
                axis.z * (e.x * f.y - e.y * f.x) <
            0;
  }
  ASSERT_GT(away, 0u);
  EXPECT_EQ(measure_distortion(d.view(), uv).flips, away);
  EXPECT_TRUE(std::isinf(planar_stretch_bound(d.view(), axis)));
}

TEST(Planar, TheProjectedShareIsThatOfTheSignedArea) {
  const Disc d = hills(5, 0.4);
  for (const Vec3d axis : {Vec3d{0, 0, 1}, {0.3, 0.9, 0.2}, {0, 0, -2}}) {
    std::vector<Vec2d> uv(d.positions.size());
    project_planar(d.view(), axis, uv);
    std::vector<TriangleStretch> s(d.triangles.size());
    measure_triangles(d.view(), uv, s);
    double area = 0, projected = 0;
    for (const TriangleStretch& t : s) {
      area += t.area;
      projected += t.uv_area;
    }
    EXPECT_NEAR(projected_share(d.view(), axis), projected / area, 1e-12);
  }
  Disc points = d;
  points.positions.assign(d.positions.size(), {1, 2, 3});
  EXPECT_EQ(projected_share(points.view(), {0, 0, 1}), 1);
}

TEST(Planar, SurvivesAClosedMeanNormal) {
  Disc d;
  d.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  d.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_EQ(mean_normal(d.view()), (Vec3d{0, 0, 1}));
}

// Returns the area of the smallest box over finely sampled directions.
double sampled_box(std::span<const Vec2d> points) {
  double best = 1e300;
  for (int k = 0; k < 3600; ++k) {
    const double angle = k * std::numbers::pi / 7200, c = std::cos(angle), s = std::sin(angle);
    double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
    for (const Vec2d p : points) {
      const double x = c * p.x + s * p.y, y = c * p.y - s * p.x;
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
    best = std::min(best, (x1 - x0) * (y1 - y0));
  }
  return best;
}

TEST(Orient, FindsTheSmallestBox) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Vec2d> points;
    const int n = 3 + static_cast<int>(seed);
    for (int i = 0; i < n; ++i) {
      const double x = 3 * normal(random), y = normal(random);
      points.push_back({x - 0.7 * y, 0.7 * x + y});
    }
    const std::vector<Vec2d> before = points;
    const Orientation o = orient_for_packing(points);
    EXPECT_LE(o.size.x * o.size.y, sampled_box(before) * (1 + 1e-9));
    EXPECT_GE(o.size.x * o.size.y, sampled_box(before) * 0.999);
    EXPECT_GE(o.size.x, o.size.y);
    Vec2d low{1e300, 1e300}, high{-1e300, -1e300};
    for (std::size_t i = 0; i < points.size(); ++i) {
      low = {std::min(low.x, points[i].x), std::min(low.y, points[i].y)};
      high = {std::max(high.x, points[i].x), std::max(high.y, points[i].y)};
      // The result is the documented rotation, not a reflection.
      const Vec2d p{before[i].x - before[0].x, before[i].y - before[0].y};
      EXPECT_NEAR(points[i].x - points[0].x, o.cosine * p.x - o.sine * p.y, 1e-12 * o.size.x);
      EXPECT_NEAR(points[i].y - points[0].y, o.sine * p.x + o.cosine * p.y, 1e-12 * o.size.x);
    }
    EXPECT_EQ(low, (Vec2d{0, 0}));
    EXPECT_NEAR(high.x, o.size.x, 1e-12 * o.size.x);
    EXPECT_NEAR(high.y, o.size.y, 1e-12 * o.size.x);
  }
}

TEST(Orient, StraightBordersWinWithinTheSlack) {
  // A square with a bump on one side. The smallest box is rotated; the long straight borders would
  // not be.
  std::vector<Vec2d> points = {{0, 0}, {1, 0}, {1, 1}, {0.5, 1.004}, {0, 1}};
  std::vector<std::array<std::uint32_t, 2>> border = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 0}};
  for (Vec2d& p : points)
    p = {std::cos(0.3) * p.x - std::sin(0.3) * p.y, std::sin(0.3) * p.x + std::cos(0.3) * p.y};
  orient_for_packing(points, border);
  double axis_aligned = 0;
  for (const auto& [a, b] : border) {
    const double x = std::abs(points[a].x - points[b].x), y = std::abs(points[a].y - points[b].y);
    if (std::min(x, y) < 1e-3 * std::max(x, y)) axis_aligned += std::max(x, y);
  }
  EXPECT_NEAR(axis_aligned, 3, 1e-3);
}

using Border = std::vector<std::array<std::uint32_t, 2>>;

// Returns the edges of a polygon given by its corners.
Border around(std::size_t corners) {
  Border border;
  for (std::uint32_t i = 0; i < corners; ++i)
    border.push_back({i, (i + 1) % static_cast<std::uint32_t>(corners)});
  return border;
}

std::vector<Vec2d> turned(std::vector<Vec2d> points, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec2d& p : points) p = {c * p.x - s * p.y, s * p.x + c * p.y};
  return points;
}

// A plate with two long straight sides. The others consist of short edges, some of which are nearly
// parallel to the long ones, and of edges without length. However it lies, the long sides end along
// the axes.
TEST(Orient, LongStraightSidesEndAlongTheAxes) {
  std::vector<Vec2d> plate{{0, 0}, {10, 0}};
  for (int i = 0; i <= 10; ++i) plate.push_back({10 + (i % 2 ? 0.3 : 0.0), 0.5 * i + 0.01});
  for (int i = 0; i < 8; ++i) plate.push_back({10 - 1.25 * i, 5.02 + 0.005 * i});
  for (int i = 0; i < 2; ++i) plate.push_back({0, 5.05});
  for (int degrees = 0; degrees < 90; degrees += 2) {
    std::vector<Vec2d> points = turned(plate, degrees * std::numbers::pi / 180);
    orient_for_packing(points, around(points.size()));
    const double x = points[1].x - points[0].x, y = points[1].y - points[0].y;
    EXPECT_LT(std::min(std::abs(x), std::abs(y)), 1e-3) << degrees;
  }
}

// Most of the points lie along the sides, where rounding could put them outside.
TEST(Orient, NoPointIsBelowZero) {
  for (int turn = 0; turn < 200; ++turn) {
    const double c = std::cos(turn), s = std::sin(turn);
    std::vector<Vec2d> points;
    for (int i = 0; i < 60; ++i) {
      for (const Vec2d p :
           {Vec2d{i / 59.0, 0}, {1, i / 59.0}, {1 - i / 59.0, 1}, {0, 1 - i / 59.0}})
        points.push_back({7 + c * p.x - s * p.y, 3 + s * p.x + c * p.y});
    }
    orient_for_packing(points);
    for (const Vec2d p : points) EXPECT_TRUE(p.x >= 0 && p.y >= 0) << turn;
  }
}

// No direction holds a fifth of a rugged circle's border, so the smallest box counts.
TEST(Orient, ARoundBorderHasTheSmallestBox) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> radius(0.99, 1);
    std::vector<Vec2d> points;
    for (int i = 0; i < 50; ++i) {
      const double angle = i * std::numbers::pi / 25, r = radius(random);
      points.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    const double smallest = sampled_box(points);
    const Orientation o = orient_for_packing(points, around(points.size()));
    EXPECT_LE(o.size.x * o.size.y, smallest * (1 + 1e-9)) << seed;
  }
}

// All edges of a stair are straight, but the box along them is far larger than the smallest one.
TEST(Orient, StraightBordersLoseBeyondTheSlack) {
  std::vector<Vec2d> stair;
  for (int i = 0; i < 20; ++i) {
    stair.push_back({double(i), double(i)});
    stair.push_back({i + 1.0, double(i)});
  }
  for (int i = 20; i > 0; --i) {
    stair.push_back({double(i), i + 1.0});
    stair.push_back({i - 1.0, i + 1.0});
  }
  std::vector<Vec2d> points = stair;
  const double smallest = sampled_box(points);
  const Orientation o = orient_for_packing(points, around(points.size()));
  EXPECT_LE(o.size.x * o.size.y, smallest * (1 + 1e-9));
}

TEST(Orient, HandlesPointsAndLines) {
  std::vector<Vec2d> none;
  EXPECT_EQ(orient_for_packing(none).size, (Vec2d{0, 0}));
  std::vector<Vec2d> one = {{5, 7}};
  EXPECT_EQ(orient_for_packing(one).size, (Vec2d{0, 0}));
  EXPECT_EQ(one[0], (Vec2d{0, 0}));
  std::vector<Vec2d> line = {{0, 0}, {3, 4}, {6, 8}, {1.5, 2}};
  const Orientation o = orient_for_packing(line);
  EXPECT_NEAR(o.size.x, 10, 1e-12);
  EXPECT_NEAR(o.size.y, 0, 1e-12);
}

}  // namespace
}  // namespace atlas
