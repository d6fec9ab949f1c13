// Texels that triangles of a chart draw twice, against a test of every texel's centre.
#include "libatlas/uvs/chart_drawing.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace atlas::test {
namespace {

constexpr int kWidth = 256, kHeight = 32;

// Corners are multiples of 1/256 of a texel, so products of their differences are exact.
using Triangle = std::array<Vec2d, 3>;

bool strictly_inside(const Triangle& t, Vec2d p) {
  for (int k = 0; k < 3; ++k) {
    const Vec2d a = t[k], b = t[(k + 1) % 3];
    if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) <= 0) return false;
  }
  return true;
}

// Triangles nearly as wide as the page, which lie on each other. Few centres lie on an edge.
TEST(ChartDrawing, CountsTexelsThatTwoTrianglesCover) {
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const auto step = [&](int least, int most) {
      return (256 * std::uniform_int_distribution<int>(least, most - 1)(random) +
              std::uniform_int_distribution<int>(1, 255)(random)) /
             256.0;
    };
    std::array<Triangle, 2> triangles;
    for (Triangle& t : triangles)
      t = {Vec2d{step(0, 60), step(0, 8)},
           {step(130, kWidth), step(0, 16)},
           {step(60, 200), step(20, kHeight)}};
    std::vector<Vec2f> uvs;
    for (const Triangle& t : triangles)
      for (const Vec2d p : t) uvs.push_back({float(p.x / kWidth), float(p.y / kHeight)});
    const std::vector<std::uint32_t> corners{0, 1, 2, 3, 4, 5};
    std::size_t both = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const Vec2d centre{x + 0.5, y + 0.5};
        both += strictly_inside(triangles[0], centre) && strictly_inside(triangles[1], centre);
      }
    }
    ChartDrawing drawing(corners, {0, 6}, uvs, {kWidth, kHeight});
    EXPECT_NEAR(double(drawing.texels_drawn_twice({0, 0})), double(both), 2) << i;
    EXPECT_GT(both, 20u);
  }
}

// The third corner of a sliver lies a twentieth of a step above the opposite side. Rounded up it
// lies above that side, rounded down below, with 41 centres on the edge from the first corner.
TEST(ChartDrawing, ASliverThatEitherRoundingMayTurnOverCountsAsTurnedOver) {
  const auto drawn_twice = [](double third) {
    const auto uv = [](double x, double y) {
      return Vec2f{float(x / kWidth), float(y / (kDrawnSteps * kHeight))};
    };
    const std::vector<Vec2f> uvs{uv(10.5, 4224), uv(100.5, 4225), uv(50.5, third)};
    const std::vector<std::uint32_t> corners{0, 1, 2};
    return ChartDrawing(corners, {0, 3}, uvs, {kWidth, kHeight}).texels_drawn_twice({0, 0});
  };
  EXPECT_EQ(drawn_twice(4224.5), 41u);
  EXPECT_EQ(drawn_twice(4224.5 + 1.0 / 4096), 41u);  // a float further up
  EXPECT_EQ(drawn_twice(4224.52), 0u);
}

TEST(ChartDrawing, TrianglesThatNameAUvTwiceAreNotDrawn) {
  const std::vector<Vec2f> uvs{{0, 0}, {1, 0}, {0, 1}};
  const std::vector<std::uint32_t> corners{0, 1, 1, 2, 2, 2, 0, 2, 0};
  ChartDrawing drawing(corners, {0, 3}, uvs, {kWidth, kHeight});
  EXPECT_EQ(drawing.texels_drawn_twice({0, 0}), 0u);
  EXPECT_EQ(drawing.thin_triangles({0, 0}), 0u);
}

}  // namespace
}  // namespace atlas::test
