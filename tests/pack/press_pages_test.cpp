// Several pages of few charts: each page is pressed, and charts are exchanged between pages.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "libatlas/pack/fitting/fit_pages.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

test::ChartItems blobs(std::size_t count, double smallest, double largest, std::uint64_t seed) {
  test::Noise noise{seed};
  std::vector<std::vector<Vec2d>> shapes;
  for (std::size_t k = 0; k < count; ++k) {
    const int corners = noise.in(5, 12);
    const double radius = smallest + (largest - smallest) * noise.unit();
    shapes.push_back(test::blob(noise, radius, corners));
  }
  return test::ChartItems(std::move(shapes));
}

pack::FitSearchOptions several(const test::ChartItems& charts, std::uint32_t pages) {
  pack::FitSearchOptions o;
  o.pages = pages;
  o.page_size = 256;
  o.alignment = 1;
  o.minimum_side = 0;
  o.max_scale = 100;
  o.shapes = charts.shapes;
  return o;
}

// Sums the signed areas of the triangles, which is valid because blobs do not overlap themselves.
double area_of(const test::ChartItems& charts) {
  double area = 0;
  for (const std::vector<Vec2d>& c : charts.corners) {
    for (std::size_t k = 0; k < c.size(); k += 3) {
      area += 0.5 * ((c[k + 1].x - c[k].x) * (c[k + 2].y - c[k].y) -
                     (c[k + 1].y - c[k].y) * (c[k + 2].x - c[k].x));
    }
  }
  return area;
}

// The pages are valid and of one scale, never less full than without pressing, and 5 % fuller in
// the geometric mean.
TEST(PressPages, PagesAreFuller) {
  double gain = 0;
  int cases = 0;
  for (const std::uint32_t pages : {2u, 4u}) {
    for (const std::uint64_t seed : {1u, 2u}) {
      const test::ChartItems charts = blobs(pages * 5 + seed, 30, 110, 10 * pages + seed);
      pack::FitSearchOptions o = several(charts, pages);
      o.padding = seed == 1 ? 1 : 2;
      const Result<FitResult> pressed = fit_pages(charts.items, o, {});
      o.press_pages = false;
      const Result<FitResult> cells = fit_pages(charts.items, o, {});
      ASSERT_TRUE(pressed.ok() && cells.ok());
      EXPECT_EQ(
          test::check_outlines(test::placed_shapes(charts, *pressed), pressed->pages, o.padding),
          "");
      ASSERT_EQ(pressed->pages.size(), pages);
      for (const Extent& page : pressed->pages) EXPECT_EQ(page, (Extent{256, 256}));
      for (const FitPlacement& p : pressed->placements) EXPECT_EQ(p.scale, pressed->scale);
      EXPECT_NEAR(pressed->utilization,
                  area_of(charts) * std::pow(pressed->scale, 2) / (256.0 * 256 * pages), 1e-9);
      EXPECT_GE(pressed->scale, cells->scale);
      gain += std::log(pressed->utilization / cells->utilization);
      ++cases;
    }
  }
  EXPECT_GT(std::exp(gain / cases), 1.05);
}

// The first page is given nine of twelve similar charts. Without an exchange, the pages would be
// packed at the scale that fits the nine.
TEST(PressPages, ChartsChangePages) {
  const test::ChartItems charts = blobs(12, 60, 70, 4);
  const pack::FitSearchOptions o = several(charts, 2);
  FitResult uneven;
  uneven.scale = 0.01;
  uneven.pages.assign(2, {256, 256});
  uneven.placements.resize(12);
  for (std::size_t i = 9; i < 12; ++i) uneven.placements[i].page = 1;
  const std::vector<pack::ChartOutline> outlines = pack::outlines_of(charts.shapes, {});
  const std::optional<FitResult> fit = pack::press_pages(uneven, {charts.items, outlines}, o, {});
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, o.padding), "");
  std::uint32_t second = 0;
  for (const FitPlacement& p : fit->placements) second += p.page;
  EXPECT_NEAR(second, 6, 1);
}

// A fit that is found first and pressed in a second step equals one made in a single step.
TEST(PressPages, AFitIsPressedLater) {
  const test::ChartItems charts = blobs(11, 30, 110, 21);
  pack::FitSearchOptions o = several(charts, 2);
  const Result<FitResult> at_once = fit_pages(charts.items, o, {});
  o.press_pages = false;
  const Result<FitResult> cells = fit_pages(charts.items, o, {});
  ASSERT_TRUE(at_once.ok() && cells.ok());
  ASSERT_GT(at_once->scale, cells->scale);
  EXPECT_EQ(pack::press_fit(*cells, charts.items, o, {})->scale, cells->scale);
  o.press_pages = true;
  const Result<FitResult> later = pack::press_fit(*cells, charts.items, o, {});
  ASSERT_TRUE(later.ok());
  EXPECT_EQ(later->scale, at_once->scale);
  EXPECT_EQ(later->lost_area, at_once->lost_area);
  for (std::size_t i = 0; i < charts.items.size(); ++i) {
    EXPECT_EQ(later->placements[i].page, at_once->placements[i].page);
    EXPECT_EQ(later->placements[i].box, at_once->placements[i].box);
    EXPECT_EQ(later->placements[i].angle, at_once->placements[i].angle);
  }
}

TEST(PressPages, SameForAnyNumberOfThreads) {
  const test::ChartItems charts = blobs(14, 30, 90, 77);
  pack::FitSearchOptions o = several(charts, 3);
  o.alignment = 4;
  Context one, eight;
  one.threads = 1;
  eight.threads = 8;
  const Result<FitResult> a = fit_pages(charts.items, o, one);
  const Result<FitResult> b = fit_pages(charts.items, o, eight);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->scale, b->scale);
  for (std::size_t i = 0; i < charts.items.size(); ++i) {
    const FitPlacement &p = a->placements[i], &q = b->placements[i];
    EXPECT_EQ(p.page, q.page);
    EXPECT_EQ(p.box, q.box);
    EXPECT_EQ(p.angle, q.angle);
    EXPECT_EQ(p.box.x % 4 + p.box.y % 4 + p.box.width % 4 + p.box.height % 4, 0);
  }
}

// Minimum sides let charts have scales of their own, and nothing can be gained where all charts
// already have the largest scale. In both cases pages stay as they were found on cells.
TEST(PressPages, NotWhereItHasNoSay) {
  const test::ChartItems charts = blobs(12, 15, 200, 5);
  pack::FitSearchOptions held = several(charts, 2), loose = several(charts, 2);
  held.minimum_side = 40;
  loose.max_scale = 0.3;
  for (pack::FitSearchOptions o : {held, loose}) {
    const Result<FitResult> with = fit_pages(charts.items, o, {});
    o.press_pages = false;
    const Result<FitResult> without = fit_pages(charts.items, o, {});
    ASSERT_TRUE(with.ok() && without.ok());
    EXPECT_EQ(with->scale, without->scale);
    for (std::size_t i = 0; i < charts.items.size(); ++i)
      EXPECT_EQ(with->placements[i].box, without->placements[i].box);
  }
}

TEST(PressPages, IsCancelled) {
  const test::ChartItems charts = blobs(16, 30, 90, 6);
  const pack::FitSearchOptions o = several(charts, 2);
  std::atomic<bool> cancel{false};
  Context context;
  context.cancel = &cancel;
  double last = 0;
  context.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
    cancel = fraction > 0.1;
  };
  EXPECT_EQ(fit_pages(charts.items, o, context).status().code(), ErrorCode::cancelled);
}

// If the pressed pages are emptier than those of the fit by more than exchanges gain, each is
// pressed once only.
TEST(PressPages, WhatCannotWinIsGivenUp) {
  const test::ChartItems charts = blobs(12, 40, 70, 4);
  const pack::FitSearchOptions o = several(charts, 2);
  pack::FitSearchOptions by_cells = o;
  by_cells.press_pages = false;
  const Result<FitResult> cells = fit_pages(charts.items, by_cells, {});
  ASSERT_TRUE(cells.ok());
  const std::vector<pack::ChartOutline> outlines = pack::outlines_of(charts.shapes, {});
  FitResult full = *cells, fuller = *cells;
  full.layouts = fuller.layouts = 0;
  fuller.scale *= 1.2;
  EXPECT_TRUE(pack::press_pages(full, {charts.items, outlines}, o, {}).has_value());
  EXPECT_FALSE(pack::press_pages(fuller, {charts.items, outlines}, o, {}).has_value());
  EXPECT_GT(fuller.layouts, 0u);
  EXPECT_GE(full.layouts, fuller.layouts);
}

}  // namespace
}  // namespace atlas
