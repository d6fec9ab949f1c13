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

TEST(ChartDrawing, TrianglesThatNameAUvTwiceAreNotDrawn) {
  const std::vector<Vec2f> uvs{{0, 0}, {1, 0}, {0, 1}};
  const std::vector<std::uint32_t> corners{0, 1, 1, 2, 2, 2, 0, 2, 0};
  ChartDrawing drawing(corners, {0, 3}, uvs, {kWidth, kHeight});
  EXPECT_EQ(drawing.texels_drawn_twice({0, 0}), 0u);
  EXPECT_EQ(drawing.thin_triangles({0, 0}), 0u);
}

}  // namespace
}  // namespace atlas::test
