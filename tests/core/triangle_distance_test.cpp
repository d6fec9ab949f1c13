// Distances from points to triangles in space.
#include "libatlas/core/triangle_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace atlas {
namespace {

glm::dvec3 anywhere(std::mt19937& random) {
  std::uniform_real_distribution<double> in(-1, 1);
  const double x = in(random), y = in(random), z = in(random);
  return {x, y, z};
}

// Of many points of the triangle none is nearer, and one is hardly farther away.
TEST(TriangleDistance, IsThatOfTheNearestPoint) {
  constexpr int kParts = 60;
  std::mt19937 random(6);
  for (int round = 0; round < 300; ++round) {
    const Triangle3 t{anywhere(random), anywhere(random), anywhere(random)};
    const glm::dvec3 p = 2.0 * anywhere(random);
    double nearest = 1e300;
    for (int i = 0; i <= kParts; ++i)
      for (int j = 0; i + j <= kParts; ++j) {
        const double u = double(i) / kParts, v = double(j) / kParts;
        nearest = std::min(nearest, glm::distance(p, t.a + u * (t.b - t.a) + v * (t.c - t.a)));
      }
    const double longest =
        std::max({glm::distance(t.a, t.b), glm::distance(t.b, t.c), glm::distance(t.c, t.a)});
    for (const double unit : {1e-3, 1.0, 1e5}) {
      const double found = distance_to(unit * p, {unit * t.a, unit * t.b, unit * t.c}) / unit;
      ASSERT_LE(found, nearest + 1e-9) << round;
      ASSERT_GE(found, nearest - longest / kParts) << round;
      ASSERT_NEAR(distance_to(unit * p, {unit * t.a, unit * t.c, unit * t.b}) / unit, found, 1e-9);
    }
  }
}

TEST(TriangleDistance, AboveTheInteriorIsTheHeight) {
  const Triangle3 t{{1, 1, 5}, {4, 1, 5}, {1, 7, 5}};
  EXPECT_DOUBLE_EQ(distance_to({2, 2, 8}, t), 3);
  EXPECT_DOUBLE_EQ(distance_to({2, 2, 1}, t), 4);
  EXPECT_DOUBLE_EQ(distance_to({2, 2, 5}, t), 0);
  EXPECT_DOUBLE_EQ(distance_to({2, 1, 5}, t), 0);
  EXPECT_DOUBLE_EQ(distance_to({2, -2, 9}, t), 5);     // from an edge
  EXPECT_DOUBLE_EQ(distance_to({-2, -3, 17}, t), 13);  // from a corner
}

TEST(TriangleDistance, OfTrianglesWithoutAreaIsThatOfTheirEdges) {
  EXPECT_DOUBLE_EQ(distance_to({2, 3, 0}, {{0, 0, 0}, {4, 0, 0}, {1, 0, 0}}), 3);
  EXPECT_DOUBLE_EQ(distance_to({7, 4, 0}, {{0, 0, 0}, {1, 0, 0}, {4, 0, 0}}), 5);
  EXPECT_DOUBLE_EQ(distance_to({4, 6, 1}, {{1, 2, 1}, {1, 2, 1}, {1, 2, 1}}), 5);
}

}  // namespace
}  // namespace atlas
