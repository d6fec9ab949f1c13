// Parts that are near each other in uv but not on the surface are moved apart, and nothing else is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libatlas/param/distortion.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/mesh/halfedges.h"
#include "libatlas/param/repair/widen.h"
#include "tests/param/oracles.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

constexpr double kPi = std::numbers::pi, kClearance = 0.05, kGap = 0.01;

struct Flat {
  Disc disc;
  std::vector<Vec2d> uvs;
};

// A turn of a spiral stair, laid flat as a ring whose two ends come within `gap` of each other.
// `rise` separates the ends on the surface.
Flat stair(double rise, double gap, double scale = 1) {
  const double arc = 2 * kPi - gap;
  const auto at = [=](double u, double v, double z) {
    const double r = scale * (1.4 - 0.4 * v);
    return Vec3d{r * std::cos(arc * u), r * std::sin(arc * u), scale * z};
  };
  Flat flat;
  flat.disc = testing::make_grid(60, 6, [&](double u, double v) { return at(u, v, rise * u); });
  flat.uvs =
      testing::drop_z(testing::make_grid(60, 6, [&](double u, double v) { return at(u, v, 0); }));
  return flat;
}

WidenOptions with(double clearance, double max_stretch = 1.25) {
  WidenOptions options;
  options.clearance = clearance;
  options.max_stretch = max_stretch;
  return options;
}

// Returns the smallest uv distance between two points sampled along the border that are more than
// `far` apart on the surface. Compares every pair.
double least_gap(const Flat& flat, double far) {
  struct Point {
    Vec2d uv;
    Vec3d place;
  };
  std::vector<Point> points;
  param::HalfEdges half_edges;
  half_edges.build(flat.disc.view());
  for (std::uint32_t h = 0; h < 3 * flat.disc.triangles.size(); ++h) {
    if (half_edges.opposite(h) != kNoIndex) continue;
    const std::uint32_t a = half_edges.from(h), b = half_edges.to(h);
    for (const double t : {0.0, 0.25, 0.5, 0.75}) {
      const auto mix = [t](double x, double y) { return x + t * (y - x); };
      const Vec3d p = flat.disc.positions[a], q = flat.disc.positions[b];
      points.push_back({{mix(flat.uvs[a].x, flat.uvs[b].x), mix(flat.uvs[a].y, flat.uvs[b].y)},
                        {mix(p.x, q.x), mix(p.y, q.y), mix(p.z, q.z)}});
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Point& p : points) {
    for (const Point& q : points) {
      const double apart =
          std::hypot(p.place.x - q.place.x, p.place.y - q.place.y, p.place.z - q.place.z);
      if (apart > far) least = std::min(least, std::hypot(p.uv.x - q.uv.x, p.uv.y - q.uv.y));
    }
  }
  return least;
}

TEST(Widen, FarPartsEndAClearanceApart) {
  Flat flat = stair(1, kGap);
  ASSERT_LT(least_gap(flat, 4 * kClearance), 0.02);
  const double before = measure_distortion(flat.disc.view(), flat.uvs).stretch_l2;
  const Widened widened = widen_mesh_gaps(flat.disc.view(), with(kClearance), flat.uvs);
  EXPECT_TRUE(widened.moved);
  EXPECT_GT(widened.near_before, 0.7);
  EXPECT_EQ(widened.near_after, 0);
  EXPECT_GT(least_gap(flat, 4 * kClearance), 0.99 * kClearance);
  EXPECT_LT(least_gap(flat, 4 * kClearance), 1.5 * kClearance) << "no more than it takes";
  EXPECT_TRUE(testing::injective_by_pairs(flat.disc.view(), flat.uvs));
  const Distortion after = measure_distortion(flat.disc.view(), flat.uvs);
  EXPECT_EQ(after.stretch_999, widened.distortion.stretch_999);
  EXPECT_LE(after.stretch_999, 1.25);
  EXPECT_LT(after.stretch_l2, before + 0.002);
}

// Both sides of a cut are the same place on the surface, so texels may mix them.
TEST(Widen, WhatIsOnePlaceOfTheSurfaceStays) {
  Flat flat = stair(0, kGap);
  const std::vector<Vec2d> before = flat.uvs;
  const Widened widened = widen_mesh_gaps(flat.disc.view(), with(kClearance), flat.uvs);
  EXPECT_FALSE(widened.moved);
  EXPECT_EQ(widened.near_before, 0);
  for (std::size_t v = 0; v < before.size(); ++v) {
    ASSERT_EQ(flat.uvs[v].x, before[v].x);
    ASSERT_EQ(flat.uvs[v].y, before[v].y);
  }
}

// Within the bound, the ends cannot be moved apart by much. What the bound allows is kept.
TEST(Widen, TheBoundIsKept) {
  for (const double slack : {1e-6, 1e-3, 1e-2}) {
    Flat flat = stair(1, kGap);
    const double bound = measure_distortion(flat.disc.view(), flat.uvs).stretch_999 * (1 + slack);
    const double gap = least_gap(flat, 4 * kClearance);
    widen_mesh_gaps(flat.disc.view(), with(kClearance, bound), flat.uvs);
    EXPECT_LE(measure_distortion(flat.disc.view(), flat.uvs).stretch_999, bound) << slack;
    EXPECT_GE(least_gap(flat, 4 * kClearance), gap * (slack < 1e-2 ? 1 - 1e-9 : 1.01)) << slack;
    EXPECT_TRUE(testing::injective_by_pairs(flat.disc.view(), flat.uvs)) << slack;
  }
}

// What stretches already, far from the ends, does not forbid to move them.
TEST(Widen, TheBoundIsNotBelowTheStretchBefore) {
  Flat flat = stair(1, kGap);
  const std::uint32_t columns = 60, middle = 30;
  for (std::uint32_t row = 1; row < 6; row += 2) flat.uvs[row * (columns + 1) + middle].x -= 0.02;
  const double before = measure_distortion(flat.disc.view(), flat.uvs).stretch_999;
  const Widened widened = widen_mesh_gaps(flat.disc.view(), with(kClearance, 1.01), flat.uvs);
  EXPECT_TRUE(widened.moved);
  EXPECT_EQ(widened.near_after, 0);
  EXPECT_GT(least_gap(flat, 4 * kClearance), 0.99 * kClearance);
  EXPECT_LE(measure_distortion(flat.disc.view(), flat.uvs).stretch_999, before);
}

// Between places that almost touch, rounding decides about the direction.
TEST(Widen, PartsThatAlmostTouchAreMovedApart) {
  for (const double gap : {1e-6, 1e-12, 1e-15}) {
    Flat flat = stair(1, gap);
    ASSERT_TRUE(check_injectivity(flat.disc.view(), flat.uvs).injective) << gap;
    EXPECT_TRUE(widen_mesh_gaps(flat.disc.view(), with(kClearance), flat.uvs).moved) << gap;
    EXPECT_GT(least_gap(flat, 4 * kClearance), 0.99 * kClearance) << gap;
    EXPECT_TRUE(check_injectivity(flat.disc.view(), flat.uvs).injective) << gap;
  }
}

TEST(Widen, UnitsOfLengthDoNotMatter) {
  Flat one = stair(1, kGap);
  widen_mesh_gaps(one.disc.view(), with(kClearance), one.uvs);
  for (const double scale : {std::ldexp(1.0, -20), 1024.0}) {
    Flat other = stair(1, kGap, scale);
    widen_mesh_gaps(other.disc.view(), with(kClearance * scale), other.uvs);
    for (std::size_t v = 0; v < one.uvs.size(); ++v) {
      ASSERT_NEAR(other.uvs[v].x / scale, one.uvs[v].x, 1e-9) << scale;
      ASSERT_NEAR(other.uvs[v].y / scale, one.uvs[v].y, 1e-9) << scale;
    }
  }
}

TEST(Widen, LooksWithoutMoving) {
  const Flat flat = stair(1, kGap);
  const Widened seen = measure_mesh_gaps(flat.disc.view(), kClearance, flat.uvs);
  EXPECT_FALSE(seen.moved);
  // The border consists of two ends of length 0.4 and two nearly closed circles.
  EXPECT_NEAR(seen.border, 0.8 + 2 * kPi * 2.4, 0.05);
  // Both ends are near entirely, and a little of the border around their corners.
  EXPECT_NEAR(seen.near_before, 0.8, 0.25);
}

// Two parallel legs of a strip that climbs, one edge of each `gap` apart from the other leg's.
// Their vertices do not face each other.
Flat legs(double gap, double angle) {
  Flat flat;
  flat.disc = testing::make_grid(60, 2, [&](double u, double v) {
    const double side = 0.5 * gap + 0.2 * (1 - v), c = std::cos(angle), s = std::sin(angle);
    const double below = 0.3 + 0.2 * (1 - v);
    double x = below * (u - 0.5) / 0.1, y = -below;
    if (u < 0.4) x = -side, y = 1 - u / 0.4;
    if (u > 0.6) x = side, y = 0.0125 + (u - 0.6) / 0.4;
    flat.uvs.push_back({c * x - s * y, s * x + c * y});
    return Vec3d{x, y, 2 * u};
  });
  return flat;
}

TEST(Widen, FindsWhatIsNearerThanTheClearanceAndNothingElse) {
  for (int degrees = 0; degrees < 360; degrees += 15) {
    const double angle = degrees * kPi / 180;
    const auto near = [&](double gap) {
      const Flat flat = legs(gap, angle);
      return measure_mesh_gaps(flat.disc.view(), kClearance, flat.uvs).near_before;
    };
    EXPECT_NEAR(near(0.99 * kClearance), 2, 0.2) << degrees;  // both legs
    EXPECT_EQ(near(1.01 * kClearance), 0) << degrees;
  }
}

// With density, the surface is as large as the uvs. What is one place and what is not depends on
// that size.
TEST(Widen, DensityScalesTheSurface) {
  for (const double rise : {2 * kClearance, 4 * kClearance, 10 * kClearance}) {
    const Flat plain = stair(rise, kGap);
    Flat dense = plain;
    for (Vec2d& p : dense.uvs) p = {2 * p.x, 2 * p.y};
    const std::vector<double> two(dense.disc.triangles.size(), 2);
    LocalMesh mesh = dense.disc.view();
    mesh.density = two;
    const Widened seen = measure_mesh_gaps(mesh, 2 * kClearance, dense.uvs);
    const Widened wanted = measure_mesh_gaps(plain.disc.view(), kClearance, plain.uvs);
    EXPECT_EQ(wanted.near_before > 0, rise > 3 * kClearance);
    EXPECT_EQ(seen.near_before, 2 * wanted.near_before) << rise;
  }
}

}  // namespace
}  // namespace atlas
