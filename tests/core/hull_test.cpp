// Distances, convex hulls and smallest rectangles of flat points.
#include "libatlas/core/hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "libatlas/core/clock.h"
#include "tests/support/slowness.h"

namespace atlas {
namespace {

TEST(Hull, ASegmentEndsAtItsEnds) {
  const Vec2d a{1, 2}, b{4, 6};  // 5 long
  EXPECT_DOUBLE_EQ(squared_distance_to_segment({1 + 1.5 - 4, 2 + 2 + 3}, a, b), 25);
  EXPECT_DOUBLE_EQ(squared_distance_to_segment({1 - 3, 2 - 4}, a, b), 25);
  EXPECT_DOUBLE_EQ(squared_distance_to_segment({4 + 6, 6 + 8}, a, b), 100);
  EXPECT_DOUBLE_EQ(squared_distance_to_segment({4, 2}, a, a), 9);
}

TEST(Hull, DistancesAreThoseOfTriangles) {
  EXPECT_DOUBLE_EQ(distance({1, 2}, {4, 6}), 5);
  EXPECT_DOUBLE_EQ(distance({1, -2}, {-4, 10}), 13);
  EXPECT_EQ(distance({3, 7}, {3, 7}), 0);
}

// All pairs of segments on a small grid. Those that cross have a common point, which is on neither
// of their ends: its places along both, by Cramer's rule, are strictly between 0 and 1.
TEST(Hull, SegmentsCrossIfTheyHaveAPointBetweenTheirEnds) {
  constexpr int kSide = 4, kPoints = kSide * kSide;
  const auto point = [](int i) { return Vec2d{double(i % kSide), double(i / kSide)}; };
  int crossing = 0;
  for (int i = 0; i < kPoints * kPoints * kPoints * kPoints; ++i) {
    const Vec2d a = point(i % kPoints), b = point(i / kPoints % kPoints),
                c = point(i / kPoints / kPoints % kPoints),
                d = point(i / kPoints / kPoints / kPoints);
    const Vec2d u{b.x - a.x, b.y - a.y}, v{d.x - c.x, d.y - c.y}, w{c.x - a.x, c.y - a.y};
    const double det = u.x * v.y - u.y * v.x;
    const double s = det != 0 ? (w.x * v.y - w.y * v.x) / det : 2,
                 t = det != 0 ? (w.x * u.y - w.y * u.x) / det : 2;
    if (s > 0 && s < 1 && t > 0 && t < 1) {
      ++crossing;
      ASSERT_TRUE(cross_each_other(a, b, c, d)) << i;
    } else if (s < 0 || s > 1 || t < 0 || t > 1) {  // parallel or apart
      ASSERT_FALSE(cross_each_other(a, b, c, d)) << i;
    }
  }
  EXPECT_GT(crossing, 1000);
}

TEST(Hull, OfFewPoints) {
  std::vector<Vec2d> none, hull, three{{0, 0}, {2, 0}, {0, 2}}, line{{0, 0}, {1, 1}, {2, 2}};
  EXPECT_EQ(hull_area(none, hull), 0);
  EXPECT_TRUE(hull.empty());
  EXPECT_EQ(hull_area(three, hull), 2);
  EXPECT_EQ(hull.size(), 3u);
  EXPECT_EQ(hull_area(line, hull), 0);
}

TEST(Hull, BoundsAreTightForRoundShapes) {
  for (const int corners : {3, 4, 5, 7, 12, 100}) {
    for (const double slim : {1.0, 0.6, 0.01}) {
      for (double turn = 0; turn < 1; turn += 0.13) {
        std::vector<Vec2d> points, hull;
        for (int i = 0; i < corners; ++i) {
          const double a = 2 * M_PI * i / corners, x = std::cos(a), y = slim * std::sin(a);
          points.push_back({1000 + std::cos(turn) * x - std::sin(turn) * y,
                            std::sin(turn) * x + std::cos(turn) * y});
        }
        const ShapeBounds bounds = bound_shape(points);
        const double area = hull_area(points, hull), box = box_area(hull);
        EXPECT_GE(bounds.hull, area);
        EXPECT_GE(bounds.box, box);
        if (slim > 0.5 && corners > 4) {
          EXPECT_LT(bounds.hull, 1.2 * area) << corners;
          EXPECT_LT(bounds.box, 1.3 * box) << corners;
        }
      }
    }
  }
  EXPECT_EQ(bound_shape({}).hull, 0);
  EXPECT_EQ(bound_shape({{1, 2}, {1, 2}}).box, 0);
}

// Returns what box_area() does, from all pairs of an edge and a corner.
double box_by_pairs(const std::vector<Vec2d>& hull) {
  double smallest = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    if (length == 0) continue;
    const double x = (b.x - a.x) / length, y = (b.y - a.y) / length;
    double low = 0, high = 0, far = 0;
    for (const Vec2d& p : hull) {
      const double along = (p.x - a.x) * x + (p.y - a.y) * y;
      low = std::min(low, along);
      high = std::max(high, along);
      far = std::max(far, (p.y - a.y) * x - (p.x - a.x) * y);
    }
    const double area = (high - low) * far;
    if (smallest == 0 || area < smallest) smallest = area;
  }
  return smallest;
}

// Random, slim and round sets, and grids, on whose hulls many corners are nearly collinear.
TEST(Hull, TheSmallestRectangleIsThatOfAllPairs) {
  std::mt19937 random(1);
  std::normal_distribution<double> spread;
  for (int k = 0; k < 2000; ++k) {
    const double slim = k % 2 == 0 ? 1 : 1e-5, turn = 3 * spread(random);
    std::vector<Vec2d> points, hull;
    for (int i = 0; i < 1 + k % 50; ++i) {
      double x = spread(random), y = spread(random);
      if (k % 3 == 1) x = float(0.1 * std::round(5 * x)), y = float(0.1 * std::round(5 * y));
      if (k % 3 == 2) x /= std::hypot(x, y), y = std::sqrt(std::max(0.0, 1 - x * x));
      y *= slim;
      points.push_back(
          {std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y});
    }
    hull_area(points, hull);
    const double wanted = box_by_pairs(hull);
    EXPECT_NEAR(box_area(hull), wanted, 1e-12 * wanted + 1e-15) << k;
  }
}

TEST(Hull, TheSmallestRectangleOfFewPoints) {
  EXPECT_EQ(box_area({}), 0);
  EXPECT_EQ(box_area({{1, 2}}), 0);
  EXPECT_EQ(box_area({{1, 2}, {3, 4}}), 0);
  EXPECT_EQ(box_area({{1, 2}, {1, 2}, {1, 2}}), 0);
  EXPECT_DOUBLE_EQ(box_area({{0, 0}, {2, 0}, {2, 0}, {0, 2}}), 4);
}

TEST(Hull, RepeatedCornersDoNotChangeTheSmallestRectangle) {
  std::mt19937 random(2);
  std::normal_distribution<double> spread;
  for (int k = 0; k < 200; ++k) {
    std::vector<Vec2d> points, hull, repeated;
    for (int i = 0; i < 3 + k % 20; ++i) points.push_back({spread(random), spread(random)});
    hull_area(points, hull);
    for (const Vec2d& p : hull) repeated.insert(repeated.end(), 1 + random() % 3, p);
    EXPECT_EQ(box_area(repeated), box_area(hull)) << k;
  }
}

TEST(Hull, TheSmallestRectangleOfManyCornersIsFoundFast) {
  std::vector<Vec2d> circle;
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    circle.push_back({std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n)});
  }
  const double begun = cpu_seconds();
  EXPECT_NEAR(box_area(circle), 4, 1e-8);
  // All pairs would take a minute.
  EXPECT_LT(cpu_seconds() - begun, 0.1 * test::kSlowness);
}

}  // namespace
}  // namespace atlas
