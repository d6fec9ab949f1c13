// Texels that triangles of a chart draw twice, against a test of every texel's centre.
#include "libatlas/uvs/chart_drawing.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <utility>
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

// The uvs lie at half steps, so that rounding might move each corner by itself.
TEST(ChartDrawing, TrianglesThatNameAUvTwiceAreNotDrawn) {
  const auto uv = [](double x, double y) {
    return Vec2f{float((x + 0.5) / (kDrawnSteps * kWidth)),
                 float((y + 0.5) / (kDrawnSteps * kHeight))};
  };
  const std::vector<Vec2f> uvs{uv(128, 127), uv(9000, 127), uv(128, 5000)};
  for (const std::array<std::uint32_t, 3> c : {std::array<std::uint32_t, 3>{0, 1, 1},
                                               {1, 1, 0},
                                               {1, 0, 1},
                                               {0, 0, 2},
                                               {2, 2, 2},
                                               {0, 2, 0}}) {
    ChartDrawing drawing(c, {0, 3}, uvs, {kWidth, kHeight});
    EXPECT_EQ(drawing.texels_drawn_twice({0, 0}), 0u) << c[0] << c[1] << c[2];
    EXPECT_EQ(drawing.thin_triangles({0, 0}), 0u) << c[0] << c[1] << c[2];
  }
}

// A row of triangles, of which every third one is turned over. uvs before those of the range belong
// to other charts.
TEST(ChartDrawing, CountsEachThinTriangle) {
  std::vector<Vec2f> uvs{{0, 0}, {0, 0}};
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const float x = float(i) / 32, wide = i % 3 == 0 ? -0.01f : 0.01f;
    corners.insert(corners.end(), {3 * i + 2, 3 * i + 3, 3 * i + 4});
    uvs.insert(uvs.end(), {{x + 0.01f, 0.1f}, {x + 0.01f + wide, 0.1f}, {x + 0.01f, 0.2f}});
  }
  ChartDrawing drawing(corners, {2, 60}, uvs, {kWidth, kHeight});
  EXPECT_EQ(drawing.thin_triangles({0, 0}), 7u);
  EXPECT_EQ(drawing.thin_triangles({5, 3}), 7u);
}

// Clockwise triangles whose corners are whole steps. Each step that such a triangle covers, edges
// included, is a texel's centre after the moves that take it there.
TEST(ChartDrawing, HitsAreTheCentresThatTurnedTrianglesWouldCover) {
  std::mt19937 random(4);
  const auto in = [&](int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(random);
  };
  constexpr std::uint32_t kTriangles = 30;
  std::vector<Vec2f> uvs;
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> wanted(std::size_t(kDrawnSteps) * kDrawnSteps, 0);
  for (std::uint32_t t = 0; t < kTriangles; ++t) {
    const int x = in(0, 30000), y = in(0, 6000), reach = t % 5 == 0 ? 700 : 12;
    std::array<std::array<std::int64_t, 2>, 3> p;
    for (auto& corner : p) corner = {x + in(0, reach), y + in(0, reach)};
    const auto side = [&](int k, std::int64_t at_x, std::int64_t at_y) {
      const auto &a = p[k % 3], &b = p[(k + 1) % 3];
      return (b[0] - a[0]) * (at_y - a[1]) - (b[1] - a[1]) * (at_x - a[0]);
    };
    if (t % 4 != 0 && side(0, p[2][0], p[2][1]) > 0) std::swap(p[1], p[2]);
    for (const auto& corner : p) {
      corners.push_back(std::uint32_t(uvs.size()));
      uvs.push_back(
          {float(corner[0]) / (kDrawnSteps * kWidth), float(corner[1]) / (kDrawnSteps * kHeight)});
    }
    if (side(0, p[2][0], p[2][1]) >= 0) continue;
    for (std::int64_t j = y; j <= y + reach; ++j)
      for (std::int64_t i = x; i <= x + reach; ++i)
        if (side(0, i, j) <= 0 && side(1, i, j) <= 0 && side(2, i, j) <= 0)
          ++wanted[std::size_t((128 - j) & 255) * kDrawnSteps + std::size_t((128 - i) & 255)];
  }
  ChartDrawing drawing(corners, {0, 3 * kTriangles}, uvs, {kWidth, kHeight});
  EXPECT_EQ(drawing.hits_of_turned(), wanted);
}

}  // namespace
}  // namespace atlas::test
