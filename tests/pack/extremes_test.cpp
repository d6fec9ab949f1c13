// Charts that suit no page. Packing must end soon and in bounded memory, either with the charts
// that fit or with one error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libatlas/core/clock.h"
#include "libatlas/pack/fitting/fit_bounds.h"
#include "libatlas/pack/outlines/chart_outline.h"
#include "libatlas/pack/outlines/outline_mask.h"
#include "tests/support/layout_checks.h"
#include "tests/support/slowness.h"

namespace atlas {
namespace {

std::vector<Vec2d> turned_quad(double width, double height, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto at = [&](double x, double y) { return Vec2d{c * x - s * y, s * x + c * y}; };
  return {at(0, 0), at(width, 0), at(width, height), at(0, 0), at(width, height), at(0, height)};
}

struct AngleRange {
  double least, most;
};

test::ChartItems needles(int count, double length, double width, AngleRange angles) {
  test::Noise noise{7};
  std::vector<std::vector<Vec2d>> charts;
  for (int i = 0; i < count; ++i) {
    const double angle = angles.least + (angles.most - angles.least) * noise.unit();
    charts.push_back(turned_quad(length, width, angle));
  }
  return test::ChartItems(std::move(charts));
}

FitOptions outlines(const test::ChartItems& charts) {
  FitOptions o;
  o.shapes = charts.shapes;
  o.page_size = 1024;
  o.padding = 2;
  o.alignment = 1;
  o.minimum_side = 1;
  o.max_scale = 1e3;
  return o;
}

// Expects every box to lie on its page.
void expect_on_pages(const FitResult& fit) {
  for (const FitPlacement& p : fit.placements) {
    ASSERT_LT(p.page, fit.pages.size());
    EXPECT_GE(std::min(p.box.x, p.box.y), 0);
    EXPECT_LE(p.box.right(), fit.pages[p.page].width);
    EXPECT_LE(p.box.top(), fit.pages[p.page].height);
  }
}

// Expects fit_pages to report that no page holds the charts, within the CPU seconds of an idle
// machine.
void expect_refused(const test::ChartItems& charts, const FitOptions& options, double seconds) {
  const double begun = cpu_seconds();
  const Result<FitResult> fit = fit_pages(charts.items, options, {});
  ASSERT_FALSE(fit.ok());
  EXPECT_EQ(fit.status().code(), ErrorCode::no_solution);
  EXPECT_LT(cpu_seconds() - begun, test::kSlowness * seconds);
}

TEST(Extremes, NeedlesOfAnyLengthTakeThePagesLength) {
  for (const double length : {1e4, 1e6, 5e8}) {
    for (const int count : {1, 20, 60}) {
      const auto charts = needles(count, length, 1, {0, 3});
      for (const bool free_aspect : {false, true}) {
        FitOptions o = outlines(charts);
        o.free_aspect = free_aspect;
        o.pages = free_aspect ? 1 : 4;
        const double begun = cpu_seconds();
        const Result<FitResult> fit = fit_pages(charts.items, o, {});
        ASSERT_TRUE(fit.ok()) << fit.status().message();
        expect_on_pages(*fit);
        // Cells do not nest slanted needles, so they share the area of one page of 1024^2 texels,
        // or of four.
        EXPECT_GT(fit->scale * length, count == 1 ? 1000 : 150) << length << " " << count;
        EXPECT_LT(cpu_seconds() - begun, 20) << length << " " << count;
      }
    }
  }
  EXPECT_LT(peak_memory(), std::int64_t{1} << 30);
}

// All teeth of the comb are far narrower than a cell. If its runs or its crossings of rows were
// stored one by one, they would take 4 GiB.
TEST(Extremes, TeethFinerThanCellsTakeLittleMemory) {
  constexpr int kTeeth = 20'000;
  std::vector<Vec2d> comb;
  for (int k = 0; k < kTeeth; ++k) {
    const double left = 2000.0 * k / kTeeth, right = 2000.0 * (k + 1) / kTeeth;
    for (const Vec2d& p :
         {Vec2d{left, 0}, Vec2d{right, 0}, Vec2d{right, 200}, Vec2d{left, 0}, Vec2d{right, 200},
          Vec2d{left, 200}, Vec2d{left, 200}, Vec2d{right, 200}, Vec2d{(left + right) / 2, 2000}})
      comb.push_back(p);
  }
  Vec2d origin;
  const pack::Mask mask = pack::rasterize(pack::outline_of({comb, {}}), {}, origin);
  EXPECT_EQ(mask.width, 2002);
  EXPECT_EQ(mask.height, 2002);
  EXPECT_EQ(mask.cells, std::int64_t{2002} * 2002);  // every cell is within a texel of a tooth
  EXPECT_LT(peak_memory(), std::int64_t{1} << 30);
}

// Cells of one texel each would take 45 GB.
TEST(Extremes, HugePagesTakeNoMoreThanLargeOnes) {
  test::Noise noise{3};
  std::vector<std::vector<Vec2d>> corners;
  for (int i = 0; i < 20; ++i) corners.push_back(test::blob(noise, 10, 40));
  const test::ChartItems charts(std::move(corners));
  FitOptions o = outlines(charts);
  o.page_size = 1 << 17;
  o.alignment = 3;
  o.power_of_two = false;
  o.padding = 7;
  o.max_scale = 1e6;
  for (const bool free_aspect : {false, true}) {
    o.free_aspect = free_aspect;
    const Result<FitResult> fit = fit_pages(charts.items, o, {});
    ASSERT_TRUE(fit.ok()) << fit.status().message();
    EXPECT_EQ(fit->pages.size(), 1u);
    EXPECT_GT(fit->utilization, 0.5);
    expect_on_pages(*fit);
    for (const FitPlacement& p : fit->placements)
      EXPECT_EQ(p.box.x % 3 + p.box.y % 3 + p.box.width % 3 + p.box.height % 3, 0);
  }
  EXPECT_LT(peak_memory(), std::int64_t{1} << 30);
}

// 10^5 triangles share only one corner. When the search for each loop's next edge there began at
// the first edge every time, it took 7 s.
TEST(Extremes, PetalsAroundOneCornerTakeLittleTime) {
  constexpr std::uint32_t kPetals = 100'000;
  std::vector<Vec2d> corners{{0, 0}};
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t k = 0; k < kPetals; ++k) {
    for (const double at : {double(k), k + 0.5}) {
      const double angle = 2 * std::numbers::pi * at / kPetals;
      corners.push_back({std::cos(angle), std::sin(angle)});
    }
    triangles.insert(triangles.end(), {0, 2 * k + 1, 2 * k + 2});
  }
  const double begun = cpu_seconds();
  const pack::ChartOutline outline = pack::outline_of({corners, triangles});
  EXPECT_LT(cpu_seconds() - begun, test::kSlowness);
  ASSERT_EQ(outline.edges.size(), 3 * kPetals);
  for (std::size_t k = 0; k < outline.edges.size(); ++k)  // loops of three edges
    EXPECT_EQ(outline.edges[k].to, outline.edges[k % 3 == 2 ? k - 2 : k + 1].from);
}

TEST(Extremes, NeedlesKeepTheirGutters) {
  const auto charts = needles(12, 1e5, 10, {0, 3});
  FitOptions o = outlines(charts);
  o.page_size = 256;
  for (const std::uint32_t pages : {1u, 3u}) {
    o.pages = pages;
    o.free_aspect = pages == 1;
    const Result<FitResult> fit = fit_pages(charts.items, o, {});
    ASSERT_TRUE(fit.ok()) << fit.status().message();
    EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, o.padding), "");
  }
}

TEST(Extremes, BoxesOfNeedles) {
  const auto charts = needles(50, 1e8, 1, {0.01, 0.02});
  FitOptions o = outlines(charts);
  o.shapes = {};
  o.max_scale = 1e6;  // far above what fits; the search must not end before it gets down to that
  const Result<FitResult> fit = fit_pages(charts.items, o, {});
  ASSERT_TRUE(fit.ok()) << fit.status().message();
  expect_on_pages(*fit);
  EXPECT_GT(fit->scale * 1e8, 500);
}

// A chart without area or gutters may meet no cell at all. That does not make it too large.
TEST(Extremes, ChartsThatMeetNoCellFitAnywhere) {
  const test::ChartItems charts({turned_quad(30, 0, 0), turned_quad(20, 20, 0)});
  FitOptions o = outlines(charts);
  o.padding = 0;
  for (const std::uint32_t pages : {1u, 2u}) {
    o.pages = pages;
    const Result<FitResult> fit = fit_pages(charts.items, o, {});
    ASSERT_TRUE(fit.ok()) << fit.status().message();
    expect_on_pages(*fit);
  }
  std::vector<ChartShape> views = charts.shapes;
  OutlineOptions options;
  options.page = {64, 64};
  options.padding = 0;
  const Result<OutlineResult> r = pack_outlines(views, options, {});
  ASSERT_TRUE(r.ok()) << r.status().message();
  EXPECT_TRUE(r->unplaced.empty());
}

// A chart that meets no cell lies within its page, wherever its points are.
TEST(Extremes, PointsLieOnTheirPage) {
  const std::vector<Vec2d> point(3, Vec2d{310, -210});
  const test::ChartItems charts({turned_quad(20, 20, 0), point, turned_quad(20, 20, 0.5)});
  FitOptions o = outlines(charts);
  o.padding = 0;
  o.page_size = 128;
  for (const std::uint32_t pages : {1u, 2u})
    for (const double max_scale : {1.0, 1e3}) {
      o.pages = pages;
      o.max_scale = max_scale;
      const Result<FitResult> fit = fit_pages(charts.items, o, {});
      ASSERT_TRUE(fit.ok()) << fit.status().message();
      EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, 0), "");
    }
  OutlineOptions options;
  options.page = {64, 64};
  options.padding = 0;
  const Result<OutlineResult> r = pack_outlines(charts.shapes, options, {});
  ASSERT_TRUE(r.ok()) << r.status().message();
  EXPECT_EQ(r->placements[1].offset.x, -310);
  EXPECT_EQ(r->placements[1].offset.y, 210);
}

// Charts whose minimum sides exceed all pages are refused without a search over scales.
TEST(Extremes, MinimumSidesBeyondThePagesAreRefusedSoon) {
  const test::ChartItems charts(std::vector<std::vector<Vec2d>>(20000, turned_quad(30, 20, 0.3)));
  FitOptions o = outlines(charts);
  o.minimum_side = 16;
  o.max_scale = 1;
  expect_refused(charts, o, 2);
}

// More charts than their gutters leave space for are refused before any is drawn.
TEST(Extremes, GuttersBeyondThePagesAreRefusedAtOnce) {
  std::vector<std::vector<Vec2d>> tiny(20000, turned_quad(1, 1, 0.3));
  const test::ChartItems charts(std::move(tiny));
  FitOptions o = outlines(charts);
  o.padding = 60;
  o.pages = 4;
  expect_refused(charts, o, 2);
}

TEST(Extremes, PackOutlinesNamesWhatNoPageHolds) {
  const std::vector<std::vector<Vec2d>> shapes{
      turned_quad(100, 50, 0), turned_quad(9e8, 1, 0.7), turned_quad(255, 5, 0),
      turned_quad(5, 130, 0),  turned_quad(300, 1, 0),   turned_quad(300, 1, std::atan(1)),
      turned_quad(0, 0, 0),    turned_quad(5e8, 5e8, 1)};
  std::vector<ChartShape> views;
  for (const auto& s : shapes) views.push_back({s, {}});
  OutlineOptions o;
  o.page = {260, 120};
  for (const std::uint32_t max_pages : {0u, 1u, 3u}) {
    o.max_pages = max_pages;
    const Result<OutlineResult> r = pack_outlines(views, o, {});
    ASSERT_TRUE(r.ok()) << r.status().message();
    // Chart 3 fits after a quarter turn. Chart 5 is longer than the page's diagonal.
    EXPECT_EQ(r->unplaced, (std::vector<std::uint32_t>{1, 4, 5, 7})) << max_pages;
  }
  // A chart that is longer than both sides of a page does not fit a strip either.
  o.page = {260, 0};
  const Result<OutlineResult> strip = pack_outlines(views, o, {});
  ASSERT_TRUE(strip.ok()) << strip.status().message();
  EXPECT_EQ(strip->unplaced, (std::vector<std::uint32_t>{1, 7}));
  EXPECT_LT(peak_memory(), std::int64_t{1} << 30);
}

TEST(Extremes, BoundsHoldForCharts) {
  test::Noise noise{11};
  for (int round = 0; round < 20; ++round) {
    std::vector<std::vector<Vec2d>> blobs;
    for (int i = noise.in(1, 20); i > 0; --i) {
      const int corners = noise.in(3, 9);
      const double radius = 100 * noise.unit() + 1;
      blobs.push_back(test::blob(noise, radius, corners));
    }
    const test::ChartItems charts(std::move(blobs));
    FitOptions o = outlines(charts);
    o.page_size = 256;
    o.pages = std::uint32_t(noise.in(1, 3));
    o.press_pages = round % 2 == 0;
    const auto drawn = pack::outlines_of(charts.shapes, {});
    const pack::FitBounds bounds = pack::fit_bounds(drawn, o, o.page_size, 4);
    EXPECT_FALSE(bounds.gutters_exceed_pages);
    const Result<FitResult> fit = fit_pages(charts.items, o, {});
    ASSERT_TRUE(fit.ok()) << fit.status().message();
    // Pressed charts may be turned by any angle, charts on cells only by quarter turns. A chart
    // that is alone on its page is pressed, too.
    const bool pressed = o.press_pages || o.pages == 1 || charts.items.size() == 1;
    EXPECT_LE(fit->scale, bounds.alone * (pressed ? std::sqrt(2.0) : 1));
    EXPECT_LE(fit->scale, bounds.with_gutters);
  }
}

}  // namespace
}  // namespace atlas
