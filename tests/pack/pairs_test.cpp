// Charts that are joined in pairs before they are laid on a page.
#include "libatlas/pack/nesting/pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;
using Shapes = std::vector<std::vector<Vec2d>>;

std::vector<ChartPair> pairs_of(Shapes shapes) {
  const test::ChartItems charts(std::move(shapes));
  return find_pairs(outlines_of(charts.shapes, {}), {});
}

std::vector<Vec2d> turned_by(std::vector<Vec2d> shape, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec2d& p : shape) p = {c * p.x - s * p.y + 7, s * p.x + c * p.y - 3};
  return shape;
}

const std::vector<Vec2d> kRight{{0, 0}, {40, 0}, {0, 30}};
const std::vector<Vec2d> kEquilateral{{0, 0}, {40, 0}, {20, 20 * std::numbers::sqrt3}};

// Returns the sides of the smallest box of a pair, over a thousand directions.
double box_area(const std::vector<Vec2d>& first, const std::vector<Vec2d>& second,
                const ChartPair& pair) {
  std::vector<Vec2d> points = first;
  const double c = std::cos(pair.turn), s = std::sin(pair.turn);
  for (const Vec2d p : second) {
    const Vec2d d{p.x - pair.end_of_second.x, p.y - pair.end_of_second.y};
    points.push_back(
        {pair.end_of_first.x + c * d.x - s * d.y, pair.end_of_first.y + s * d.x + c * d.y});
  }
  double least = 1e300;
  for (int k = 0; k < 1000; ++k) {
    const double a = std::numbers::pi / 2 * k / 1000, ca = std::cos(a), sa = std::sin(a);
    double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
    for (const Vec2d p : points) {
      const double x = ca * p.x + sa * p.y, y = ca * p.y - sa * p.x;
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
    least = std::min(least, (x1 - x0) * (y1 - y0));
  }
  return least;
}

TEST(Pairs, RightTrianglesMakeRectangles) {
  for (const double angle : {0.0, 0.3, 2.0, std::numbers::pi}) {
    const std::vector<Vec2d> other = turned_by(kRight, angle);
    const std::vector<ChartPair> pairs = pairs_of({kRight, other});
    ASSERT_EQ(pairs.size(), 1u) << angle;
    EXPECT_NEAR(box_area(kRight, other, pairs[0]), 1200, 12) << angle;
    EXPECT_NEAR(std::hypot(pairs[0].normal.x, pairs[0].normal.y), 1, 1e-12);
  }
}

TEST(Pairs, EquilateralTrianglesMakeRhombs) {
  const std::vector<ChartPair> pairs = pairs_of({kEquilateral, kEquilateral});
  ASSERT_EQ(pairs.size(), 1u);
  // A rhomb of 60 degrees fills two thirds of its smallest box.
  EXPECT_NEAR(box_area(kEquilateral, kEquilateral, pairs[0]), 3 * 20 * 20 * std::numbers::sqrt3,
              40);
}

TEST(Pairs, AreNotMadeOfChartsThatFillTheirBoxesOrAreConcave) {
  test::Noise noise{5};
  const std::vector<Vec2d> octagon = test::blob(noise, 30, 40);
  const std::vector<Vec2d> corner{{0, 0}, {40, 0}, {40, 4}, {0, 0}, {40, 4}, {4, 4},
                                  {0, 0}, {4, 4},  {4, 40}, {0, 0}, {4, 40}, {0, 40}};
  EXPECT_TRUE(pairs_of({test::box(30, 20), test::box(30, 20)}).empty());
  EXPECT_TRUE(pairs_of({octagon, octagon}).empty());
  EXPECT_TRUE(pairs_of({corner, corner}).empty());
  EXPECT_TRUE(pairs_of({kRight, test::box(50, 40)}).empty());
  EXPECT_TRUE(pairs_of({kRight}).empty());
  EXPECT_TRUE(pairs_of({}).empty());
  EXPECT_TRUE(pairs_of({{{1, 1}, {1, 1}, {1, 1}}, {{0, 0}, {1, 1}, {2, 2}}}).empty())
      << "neither has an area";
}

TEST(Pairs, HaveEdgesOfSimilarLength) {
  std::vector<Vec2d> half = kRight;
  for (Vec2d& p : half) p = {0.45 * p.x, 0.45 * p.y};
  EXPECT_TRUE(pairs_of({kRight, half}).empty());
  const std::vector<ChartPair> pairs = pairs_of({kRight, half, half, kRight});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].first, 0u);
  EXPECT_EQ(pairs[0].second, 3u);
}

TEST(Pairs, HoldEveryChartOnce) {
  test::Noise noise{8};
  Shapes shapes;
  for (int k = 0; k < 301; ++k)
    shapes.push_back({{0, 0}, {20 + 30 * noise.unit(), 0}, {0, 20 + 30 * noise.unit()}});
  const std::vector<ChartPair> pairs = pairs_of(shapes);
  EXPECT_GT(pairs.size(), 140u);
  std::set<std::uint32_t> seen;
  for (const ChartPair& p : pairs) {
    EXPECT_TRUE(seen.insert(p.first).second);
    EXPECT_TRUE(seen.insert(p.second).second);
  }
}

TEST(Pairs, HaveMasksThatDoNotOverlap) {
  const test::ChartItems charts({kRight, turned_by(kRight, 1.1)});
  const std::vector<ChartOutline> outlines = outlines_of(charts.shapes, {});
  const std::vector<ChartPair> pairs = find_pairs(outlines, {});
  ASSERT_EQ(pairs.size(), 1u);
  for (const int padding : {0, 1, 4})
    for (const int cell : {1, 4}) {
      PieceOptions options;
      options.padding = padding;
      options.cell = cell;
      options.directions = 8;
      const std::vector<double> factors{1.5, 1.5};
      const JoinedPiece pair = make_pair_piece({outlines, factors}, pairs[0], options);
      ASSERT_EQ(pair.piece.masks.size(), 8u);
      for (std::uint32_t k = 0; k < 8; ++k) {
        const Mask& mask = pair.piece.masks[k];
        std::vector<test::PlacedShape> placed;
        for (int c = 0; c < 2; ++c) {
          const JoinedPart& part = pair.parts[k][std::size_t(c)];
          EXPECT_GE(part.cells.x, 0);
          EXPECT_GE(part.cells.y, 0);
          EXPECT_LE(part.cells.right(), mask.width);
          EXPECT_LE(part.cells.top(), mask.height);
          const double angle = std::numbers::pi / 4 * k + (c == 1 ? pairs[0].turn : 0);
          const std::uint32_t chart = c == 1 ? pairs[0].second : pairs[0].first;
          placed.push_back(
              {charts.shapes[chart],
               0,
               1.5,
               angle,
               {part.cells.x * cell + part.origin.x, part.cells.y * cell + part.origin.y}});
        }
        const std::vector<Extent> page{{mask.width * cell, mask.height * cell}};
        EXPECT_EQ(test::check_outlines(placed, page, padding), "") << padding << " " << cell;
        // The gutter between both takes no more than a strip along the longest edge.
        const double strip = 75.0 / cell * (2.0 * padding + 3 * cell) * 2 / cell;
        EXPECT_LT(double(mask.cells), 2 * 1350.0 / (cell * cell) + 6 * strip);
      }
    }
}

}  // namespace
}  // namespace atlas
