#include "libatlas/raster/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/raster/random_triangles.h"

namespace atlas {
namespace {

TEST(SampleGrid, HasASquareOfPositionsThatShareNoRowOrColumn) {
  for (const int shifts : {1, 2, 4, 5, 9, 16, 60, 64, 1000}) {
    const SampleGrid grid(shifts);
    EXPECT_EQ(grid.count, grid.side * grid.side);
    EXPECT_GE(grid.count, std::min(shifts, 64));
    EXPECT_LE(grid.count, 64);
    std::set<long> xs, ys;
    double mx = 0, my = 0;
    for (int k = 0; k < grid.count; ++k) {
      const Vec2d o = grid.offset[k];
      EXPECT_TRUE(o.x > 0 && o.x < 1 && o.y > 0 && o.y < 1);
      xs.insert(std::lround(o.x * 1e6));
      ys.insert(std::lround(o.y * 1e6));
      mx += o.x / grid.count;
      my += o.y / grid.count;
    }
    EXPECT_EQ(xs.size(), std::size_t(grid.count));
    EXPECT_EQ(ys.size(), std::size_t(grid.count));
    EXPECT_NEAR(mx, 0.5, 1e-12);
    EXPECT_NEAR(my, 0.5, 1e-12);
  }
}

struct Sum {
  double weight = 0, x = 0, y = 0;
  int samples = 0;
};

Sum samples(const TexelTriangle& t, const SampleGrid& grid) {
  Sum s;
  const auto add = [&](double x, double y, double w) {
    s.weight += w;
    s.x += w * x;
    s.y += w * y;
    ++s.samples;
  };
  const auto row = [&](int k, int y, int x0, int x1) {
    for (int x = x0; x < x1; ++x) add(x + grid.offset[k].x, y + grid.offset[k].y, 1.0 / grid.count);
  };
  const auto point = [&](const float* b, float w) {
    EXPECT_NEAR(b[0] + b[1] + b[2], 1, 1e-5);
    for (int k = 0; k < 3; ++k) EXPECT_GE(b[k], -1e-6);
    add(b[0] * t[0].x + b[1] * t[1].x + b[2] * t[2].x,
        b[0] * t[0].y + b[1] * t[1].y + b[2] * t[2].y, w);
  };
  sample_triangle(t, {-300, -300, 900, 900}, grid, SampleVisitor{row, point});
  return s;
}

TEST(SampleTriangle, WeighsSmallAndThinTrianglesByTheirExactArea) {
  for (const int shifts : {1, 4, 16}) {
    const SampleGrid grid(shifts);
    int points = 0, thin = 0;
    for (const TexelTriangle& t : random_triangles(4000, 7, 100)) {
      const SampleKind kind = sample_kind(t, grid);
      if (kind != SampleKind::points && kind != SampleKind::thin) continue;
      const Sum s = samples(t, grid);
      const double area = 0.5 * std::fabs(cross_area(t));
      ASSERT_NEAR(s.weight, area, 2e-5 * area);
      const double size = std::sqrt(
          std::max({raster_detail::length2(t[0], t[1]), raster_detail::length2(t[1], t[2]),
                    raster_detail::length2(t[2], t[0])}));
      ASSERT_NEAR(s.x / s.weight, (t[0].x + t[1].x + t[2].x) / 3, 1e-4 * (1 + size));
      ASSERT_NEAR(s.y / s.weight, (t[0].y + t[1].y + t[2].y) / 3, 1e-4 * (1 + size));
      ++(kind == SampleKind::points ? points : thin);
    }
    EXPECT_GT(points, 100);
    EXPECT_GT(thin, 100);
  }
}

TEST(SampleTriangle, MissesNoTriangleThatHasArea) {
  for (const int shifts : {1, 4, 9}) {
    const SampleGrid grid(shifts);
    for (const TexelTriangle& t : random_triangles(3000, 8, 60)) {
      const double area = 0.5 * std::fabs(cross_area(t));
      if (area == 0) continue;
      const Sum s = samples(t, grid);
      ASSERT_GT(s.samples, 0) << area;
      // The samples on a grid estimate the area with an error of about the area of the cells along
      // the outline.
      double outline = 0;
      for (int k = 0; k < 3; ++k)
        outline += std::sqrt(raster_detail::length2(t[k], t[(k + 1) % 3]));
      ASSERT_NEAR(s.weight, area, 2e-5 * area + 0.75 * (outline + 1) / grid.side);
    }
  }
}

TEST(SampleTriangle, NeedsFewSamplesForTinyOnesAndAboutTheirLengthForNeedles) {
  const SampleGrid grid(4);
  EXPECT_EQ(samples({Vec2d{5, 5}, {5.1, 5}, {5, 5.05}}, grid).samples, 1);
  EXPECT_EQ(samples({Vec2d{5, 5}, {5.6, 5}, {5, 5.5}}, grid).samples, 3);
  // In slices as wide as a step of the grid, whichever of the edges is the longest.
  const Vec2d needle[3] = {{0, 0}, {500, 300}, {250, 150.001}};
  for (int k = 0; k < 3; ++k) {
    const int count = samples({needle[k], needle[(k + 1) % 3], needle[(k + 2) % 3]}, grid).samples;
    EXPECT_GE(count, 583) << k;
    EXPECT_LE(count, 585) << k;
  }
}

// Points of quadrature stand for triangles whose longest edge is at most two steps of the grid.
TEST(SampleTriangle, LargerThanTwoStepsIsSampledByTheGrid) {
  for (const int side : {2, 4, 8}) {
    const SampleGrid grid(side * side);
    const auto kind = [&](double edge) {
      return sample_kind({Vec2d{5, 5}, {5 + edge, 5}, {5 + edge / 2, 5 + 0.8 * edge}}, grid);
    };
    EXPECT_EQ(kind(1.99 / side), SampleKind::points) << side;
    EXPECT_EQ(kind(2.01 / side), SampleKind::grid) << side;
  }
}

TEST(SampleTriangle, ASingleShiftIsTheCentre) {
  const SampleGrid grid(1);
  EXPECT_EQ(grid.offset[0], (Vec2d{0.5, 0.5}));
  EXPECT_EQ(samples({Vec2d{5, 5}, {5.6, 5}, {5, 5.5}}, grid).samples, 1);
}

}  // namespace
}  // namespace atlas
