// Copies of one chart: they are recognised, and laid in rows that interlock.
#include "libatlas/pack/nesting/rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;
using Shape = std::vector<Vec2d>;  // three corners per triangle
using Shapes = std::vector<Shape>;

Shape polygon(int corners, double radius) {
  const auto at = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    return Vec2d{radius * std::cos(angle), radius * std::sin(angle)};
  };
  Shape shape;
  for (int k = 1; k + 1 < corners; ++k) shape.insert(shape.end(), {at(0), at(k), at(k + 1)});
  return shape;
}

// An L of two arms as wide as `width`.
Shape corner(double long_arm, double short_arm, double width) {
  return {{0, 0},         {long_arm, 0},      {long_arm, width},
          {0, 0},         {long_arm, width},  {width, width},
          {0, 0},         {width, width},     {0, short_arm},
          {width, width}, {width, short_arm}, {0, short_arm}};
}

Shape moved(const Shape& shape, double angle, Vec2d by) {
  const double c = std::cos(angle), s = std::sin(angle);
  Shape result;
  for (const Vec2d& p : shape)
    result.push_back({c * p.x - s * p.y + by.x, s * p.x + c * p.y + by.y});
  return result;
}

Shapes copies(const Shape& shape, int count) {
  test::Noise noise{3};
  Shapes all;
  for (int k = 0; k < count; ++k)
    all.push_back(moved(shape, 7 * noise.unit(), {100 * noise.unit(), 100 * noise.unit()}));
  return all;
}

std::vector<AlikeCharts> alike(Shapes shapes, std::size_t fewest = 2) {
  const test::ChartItems charts(std::move(shapes));
  return find_alike(outlines_of(charts.shapes, {}), fewest, {});
}

TEST(Alike, CopiesAreFoundWhateverTheirTurnAndFirstCorner) {
  Shape base = corner(40, 25, 7);
  for (const double angle : {0.0, 1.0, -2.5, std::numbers::pi}) {
    Shape other = moved(base, angle, {1000, -30});
    std::rotate(other.begin(), other.begin() + 6, other.end());  // begins with another triangle
    const std::vector<AlikeCharts> groups = alike({base, polygon(5, 30), other});
    ASSERT_EQ(groups.size(), 1u) << angle;
    ASSERT_EQ(groups[0].charts, (std::vector<std::uint32_t>{0, 2}));
    EXPECT_NEAR(std::remainder(groups[0].turns[1] + angle, 2 * std::numbers::pi), 0, 1e-9) << angle;
  }
}

TEST(Alike, OtherShapesSizesAndMirrorImagesAreNot) {
  const Shape base = corner(40, 25, 7);
  Shape mirrored;
  for (std::size_t k = 0; k < base.size(); k += 3)
    for (const std::size_t c : {k, k + 2, k + 1}) mirrored.push_back({-base[c].x, base[c].y});
  EXPECT_TRUE(alike({base, mirrored}).empty());
  EXPECT_TRUE(alike({base, corner(40, 27, 7)}).empty());
  EXPECT_TRUE(alike({base, corner(40.5, 25.3, 7.1)}).empty());
  EXPECT_TRUE(alike({base, base}, 3).empty());
}

TEST(Alike, GroupsComeByTheirArea) {
  Shapes shapes = copies(polygon(6, 5), 6);
  for (const Shape& s : copies(corner(40, 25, 7), 3)) shapes.insert(shapes.begin() + 1, s);
  const std::vector<AlikeCharts> groups = alike(shapes);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].charts, (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_EQ(groups[1].charts, (std::vector<std::uint32_t>{0, 4, 5, 6, 7, 8}));
}

double density_of(const Shape& shape) {
  const test::ChartItems charts(copies(shape, 30));
  const std::vector<RowPlan> plans = find_rows(outlines_of(charts.shapes, {}), {});
  EXPECT_EQ(plans.size(), 1u);
  return plans.empty() ? 0 : plans[0].density;
}

// The density of the best lattice is 1 for shapes that tile the plane, 0.9213 for regular
// pentagons, and 0.9069 for discs. Plans fall short of it by the cells along borders.
TEST(Rows, AreNearlyAsDenseAsTheBestLattice) {
  for (const auto& [shape, best] : {std::pair{polygon(3, 20), 1.0},
                                    {polygon(4, 20), 1.0},
                                    {polygon(6, 20), 1.0},
                                    {corner(30, 30, 10), 1.0},
                                    {polygon(5, 20), 0.9213},
                                    {polygon(64, 20), 0.9069}}) {
    EXPECT_LE(density_of(shape), best) << shape.size();
    EXPECT_GE(density_of(shape), best - 0.16) << shape.size();
  }
}

TEST(Rows, KeepGuttersAndTheirLength) {
  for (const Shape& shape : {corner(40, 25, 7), polygon(5, 20), polygon(3, 25)}) {
    const test::ChartItems charts(copies(shape, 40));
    const std::vector<ChartOutline> outlines = outlines_of(charts.shapes, {});
    const std::vector<RowPlan> plans = find_rows(outlines, {});
    ASSERT_EQ(plans.size(), 1u);
    const std::vector<double> factors(40, 1.5);
    for (const int padding : {0, 1, 4})
      for (const int cell : {1, 4}) {
        PieceOptions options;
        options.padding = padding;
        options.cell = cell;
        options.directions = 8;
        const std::int32_t length = 600 / cell;
        std::multiset<std::uint32_t> seen;
        const auto rows = make_row_pieces({outlines, factors}, plans[0], options, length);
        EXPECT_GT(rows.size(), 1u);
        EXPECT_LT(rows.size(), 20u);
        for (const JoinedPiece& row : rows) {
          const Mask& mask = row.piece.masks[0];
          EXPECT_LE(mask.width, length);
          std::vector<test::PlacedShape> placed;
          for (const JoinedPart& part : row.parts[0]) {
            seen.insert(part.chart);
            placed.push_back(
                {charts.shapes[part.chart],
                 0,
                 1.5,
                 part.turn,
                 {part.cells.x * cell + part.origin.x, part.cells.y * cell + part.origin.y}});
          }
          const std::vector<Extent> page{{mask.width * cell, mask.height * cell}};
          EXPECT_EQ(test::check_outlines(placed, page, padding), "") << padding << " " << cell;
        }
        EXPECT_EQ(seen.size(), 40u);
        EXPECT_EQ(std::set(seen.begin(), seen.end()).size(), 40u);
      }
  }
}

// Placed one by one, copies take directions that leave gaps into which no other fits: they fill
// 0.60, 0.70 and 0.68 at most.
TEST(Rows, FillPagesMore) {
  for (const auto& [shape, filled] :
       {std::pair{corner(30, 30, 10), 0.65}, {polygon(6, 20), 0.73}, {polygon(5, 20), 0.69}}) {
    Shapes shapes = copies(shape, 500);
    const test::ChartItems charts(std::move(shapes));
    FitOptions options = test::options_for(charts, 1024);
    for (const std::uint32_t pages : {1u, 2u}) {
      options.free_aspect = pages == 1;
      options.pages = pages;
      Context context;
      context.threads = 1;
      const Result<FitResult> fit = fit_pages(charts.items, options, context);
      ASSERT_TRUE(fit.ok()) << fit.status().message();
      EXPECT_EQ(
          test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, options.padding), "");
      EXPECT_GT(fit->utilization, filled) << shape.size();
      context.threads = 3;
      const Result<FitResult> again = fit_pages(charts.items, options, context);
      ASSERT_TRUE(again.ok());
      EXPECT_EQ(again->scale, fit->scale);
      for (std::size_t k = 0; k < 500; ++k) {
        EXPECT_EQ(again->placements[k].angle, fit->placements[k].angle);
        EXPECT_EQ(again->placements[k].offset.x, fit->placements[k].offset.x);
      }
    }
  }
}

}  // namespace
}  // namespace atlas
