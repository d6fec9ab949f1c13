#include "libatlas/pack/pressing/straight_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "libatlas/pack/outlines/chart_outline.h"
#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;
using test::box;
using test::options_for;

// Charts with straight sides lie side by side, turned by right angles. The charts are notched bars,
// some of which fill the notches of others.
TEST(StraightPage, ChartsLieSideBySide) {
  test::Noise noise{12};
  std::vector<std::vector<Vec2d>> bars;
  for (int k = 0; k < 40; ++k) {
    const double w = noise.in(40, 200), h = noise.in(20, 50), x = noise.in(20, 80) * w / 100;
    std::vector<Vec2d> bar = box(w, h);
    for (const Vec2d p : box(x, h / 2)) bar.push_back({p.x, p.y + h});
    bars.push_back(bar);
  }
  const test::ChartItems charts(std::move(bars));
  FitOptions o = options_for(charts, 1024);
  ASSERT_TRUE(is_straight(outlines_of(charts.shapes, {})));
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  const Result<FitResult> page = fit_pages(charts.items, o, one);
  const Result<FitResult> again = fit_pages(charts.items, o, three);
  ASSERT_TRUE(page.ok() && again.ok());
  EXPECT_GT(page->utilization, 0.8);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *page), page->pages, 1), "");
  EXPECT_EQ(page->pages, again->pages);
  for (std::size_t i = 0; i < charts.items.size(); ++i) {
    const double quarters = page->placements[i].angle / (std::numbers::pi / 2);
    EXPECT_EQ(quarters, std::round(quarters));
    EXPECT_EQ(page->placements[i].box, again->placements[i].box);
  }
}

// Two interlocking pairs of U shapes fill a page in one row, which is twice as long as high. Pages
// from the square down to 0.6 of its height have no room for both pairs side by side.
TEST(StraightPage, InterlockingPairsLieInARow) {
  std::vector<std::vector<Vec2d>> shapes;
  for (int k = 0; k < 4; ++k) {
    std::vector<Vec2d> shape = box(20, 4);
    for (const Vec2d p : box(4, 16)) shape.push_back({p.x, p.y + 4});
    for (const Vec2d p : box(4, 16)) shape.push_back({p.x + 16, p.y + 4});
    shapes.push_back(shape);
  }
  const test::ChartItems charts(std::move(shapes));
  const FitOptions o = options_for(charts, 2048);
  ASSERT_TRUE(is_straight(outlines_of(charts.shapes, {})));
  const Result<FitResult> page = fit_pages(charts.items, o, {});
  ASSERT_TRUE(page.ok());
  EXPECT_GT(page->utilization, 0.69);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *page), page->pages, o.padding), "");
}

// `best` keeps to its effort on a square page, and is never worse than the search over cells.
TEST(StraightPage, BestIsNoWorseOnASquarePage) {
  std::vector<std::vector<Vec2d>> bars;
  for (int k = 0; k < 12; ++k) bars.push_back(box(60 + 17 * k, 20 + 11 * (k % 5)));
  const test::ChartItems charts(std::move(bars));
  FitOptions o = options_for(charts, 512);
  o.free_aspect = false;
  const Result<FitResult> standard = fit_pages(charts.items, o, {});
  o.preset = PackPreset::best;
  o.effort = 1;
  const Result<FitResult> best = fit_pages(charts.items, o, {});
  ASSERT_TRUE(standard.ok() && best.ok());
  EXPECT_GE(best->scale, standard->scale);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *best), best->pages, 1), "");
}

// Masks consist of whole blocks, as pages with mip levels need.
TEST(StraightPage, KeepsTheAlignment) {
  std::vector<std::vector<Vec2d>> bars;
  for (int k = 0; k < 20; ++k) bars.push_back(box(60 + 7 * k, 20 + 3 * k));
  const test::ChartItems charts(std::move(bars));
  FitOptions o = options_for(charts, 1024);
  o.padding = 4;
  o.alignment = 8;
  const Result<FitResult> page = fit_pages(charts.items, o, {});
  ASSERT_TRUE(page.ok());
  EXPECT_GT(page->utilization, 0.6);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *page), page->pages, 4), "");
  for (const FitPlacement& p : page->placements) {
    EXPECT_EQ(p.box.x % 8, 0);
    EXPECT_EQ(p.box.y % 8, 0);
    EXPECT_EQ(p.box.width % 8, 0);
  }
}

// Triangles of about the same size; a layout of them takes far more work than one of other charts.
TEST(StraightPage, WorkIsLimited) {
  test::Noise noise{3};
  std::vector<std::vector<Vec2d>> triangles;
  for (int k = 0; k < 100; ++k) {
    const double w = 80 + 10 * noise.unit(), h = 8 + 6 * noise.unit();
    triangles.push_back({{0, 0}, {w, 0}, {w * noise.unit(), h}});
  }
  const test::ChartItems charts(std::move(triangles));
  FitSearchOptions o = options_for(charts, 1024);
  const std::vector<ChartOutline> outlines = outlines_of(charts.shapes, {});
  ASSERT_TRUE(is_straight(outlines));
  const PressedPage standard = pack_straight(outlines, o, {});
  EXPECT_GT(standard.scale, 0);
  EXPECT_LT(standard.layouts, 12 * 20u);
  o.first_round = 0.25;  // of the work, and so of the starts
  const PressedPage quick = pack_straight(outlines, o, {});
  EXPECT_GT(quick.scale, 0);
  EXPECT_LT(quick.layouts, standard.layouts / 2);
}

}  // namespace
}  // namespace atlas
