// Tests fit_pages() with outlines of charts.
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/pack/fit.h"
#include "tests/pack/fits.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using test::fit;
using test::tight;

// Gutters that take the very last texel leave none for a chart.
TEST(FitShapes, NothingFitsBetweenGutters) {
  for (const int count : {4, 16}) {
    test::Noise noise{3};
    std::vector<std::vector<Vec2d>> blobs;
    for (int k = 0; k < count; ++k) blobs.push_back(test::blob(noise, 20 + k, 7));
    const test::ChartItems charts(std::move(blobs));
    FitOptions o;
    o.page_size = 256;
    o.padding = count == 4 ? 64 : 32;
    o.alignment = 1;
    o.minimum_side = 0;
    o.shapes = charts.shapes;
    EXPECT_EQ(fit_pages(charts.items, o, {}).status().code(), ErrorCode::no_solution) << count;
    o.padding /= 2;
    const Result<FitResult> fit = fit_pages(charts.items, o, {});
    ASSERT_TRUE(fit.ok());
    EXPECT_EQ(fit->placements.size(), charts.items.size());
  }
}

TEST(FitShapes, OutlinesFitMoreThanBoxes) {
  test::Noise noise{31};
  std::vector<std::vector<Vec2d>> blobs;
  for (int k = 0; k < 120; ++k) blobs.push_back(test::blob(noise, 20 + 60 * noise.unit(), 7));
  const test::ChartItems charts(std::move(blobs));
  FitOptions o;
  o.pages = 2;
  o.page_size = 256;
  o.padding = 2;
  o.alignment = 4;
  o.minimum_side = 0;
  const FitResult boxes = fit(charts.items, o);
  o.shapes = charts.shapes;
  const FitResult outlines = fit(charts.items, o);
  EXPECT_GT(outlines.scale, boxes.scale);
  for (const FitPlacement& p : outlines.placements) EXPECT_GE(p.scale, outlines.scale);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, outlines), outlines.pages, o.padding),
            "");
}

// Rectangles; a third of them have a slanted side.
test::ChartItems straight_charts(std::uint64_t seed, int count) {
  test::Noise noise{seed};
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < count; ++k) {
    const double w = 10 + 50 * noise.unit(), h = 10 + 25 * noise.unit();
    const double cut = k % 3 == 0 ? 0.6 * w : 0;
    shapes.push_back({{0, 0}, {w, 0}, {w - cut, h}, {0, 0}, {w - cut, h}, {0, h}});
  }
  return test::ChartItems(std::move(shapes));
}

// At oblique angles each chart finds a lower place, but the layout as a whole gets worse.
TEST(FitShapes, MoreDirectionsAreNeverWorseThanFour) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const test::ChartItems charts = straight_charts(seed, 60);
    FitOptions o = tight(128);
    o.pages = 2;
    o.shapes = charts.shapes;
    const double four = fit(charts.items, o).scale;
    for (const std::uint32_t rotations : {8u, 16u, 64u}) {
      o.rotations = rotations;
      const FitResult more = fit(charts.items, o);
      EXPECT_GE(more.scale, four) << rotations;
      EXPECT_LE(more.packings, o.max_packings);
      EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, more), more.pages, o.padding), "");
    }
  }
}

// Triangles of given uvs may lie on each other many times, as in charts of tiled textures.
TEST(FitShapes, ChartsThatLieOnThemselvesTakeTheirRoomOnce) {
  std::vector<std::vector<Vec2d>> once, often;
  test::Noise noise{7};
  for (int k = 0; k < 40; ++k) {
    const double w = 10 + 50 * noise.unit(), h = 10 + 25 * noise.unit();
    once.push_back({{0, 0}, {w, 0}, {w, h}, {0, 0}, {w, h}, {0, h}});
    often.push_back(once.back());
    for (int copy = 0; copy < 9; ++copy) {  // every other copy has the opposite orientation
      const double x = w * copy / 9;
      if (copy % 2 == 0)
        often.back().insert(often.back().end(), {{0, 0}, {x, 0}, {w, h}});
      else
        often.back().insert(often.back().end(), {{0, 0}, {w, h}, {x, 0}});
      often.back().insert(often.back().end(), once.back().begin(), once.back().end());
    }
  }
  const test::ChartItems single(std::move(once)), stacked(std::move(often));
  FitOptions o = tight(256);
  o.shapes = single.shapes;
  const FitResult wanted = fit(single.items, o);
  o.shapes = stacked.shapes;
  const FitResult result = fit(stacked.items, o);
  EXPECT_GT(result.scale, 0.97 * wanted.scale);
  EXPECT_NEAR(result.utilization / (result.scale * result.scale),
              wanted.utilization / (wanted.scale * wanted.scale), 1e-3);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(stacked, result), result.pages, o.padding),
            "");
}

// In rows, charts on coarser cells fill a page nearly as far as on cells of a texel.
TEST(FitShapes, FewStraightChartsFillAPageAsWellAsByCells) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const test::ChartItems charts = straight_charts(seed, 12);
    FitOptions o = tight(512);
    o.max_scale = 100;
    o.free_aspect = true;
    o.power_of_two = false;
    o.shapes = charts.shapes;
    const FitResult either = fit(charts.items, o);
    EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, either), either.pages, o.padding),
              "");
    o.any_angle = false;
    EXPECT_GT(either.utilization, 0.95 * fit(charts.items, o).utilization) << seed;
  }
}

// The page is too small for pressing, and only the effort limits packings that fail.
TEST(FitShapes, PackingsShareTheEffort) {
  test::Noise noise{5};
  std::vector<std::vector<Vec2d>> blobs;
  for (int k = 0; k < 6; ++k) blobs.push_back(test::blob(noise, 20 + 10 * noise.unit(), 7));
  const test::ChartItems charts(std::move(blobs));
  FitOptions o;
  o.page_size = 64;
  o.padding = o.alignment = 1;
  o.minimum_side = 0;
  o.max_scale = 100;
  o.free_aspect = true;
  o.shapes = charts.shapes;
  const Result<FitResult> standard = fit_pages(charts.items, o, {});
  o.preset = PackPreset::best;
  o.effort = 400;
  const Result<FitResult> best = fit_pages(charts.items, o, {});
  ASSERT_TRUE(standard.ok() && best.ok());
  EXPECT_GE(best->scale, standard->scale);
  EXPECT_GT(best->layouts, standard->layouts);
}

}  // namespace
}  // namespace atlas
