// Pages of any shape whose charts have a given scale.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using test::options_for;
using Shapes = std::vector<std::vector<Vec2d>>;

// Ellipses of 16 sizes between 10 and 80 texels, as fans of triangles.
Shapes ellipses(int count) {
  Shapes all;
  for (int k = 0; k < count; ++k) {
    const double width = 10 + 2 * (k % 16), height = 5 + 1.5 * ((7 * k) % 16);
    std::vector<Vec2d> corners;
    constexpr int kCorners = 30;
    for (int i = 0; i < kCorners; ++i) {
      const auto at = [&](int n) {
        const double angle = 2 * std::numbers::pi * n / kCorners;
        return Vec2d{width * std::cos(angle), height * std::sin(angle)};
      };
      corners.insert(corners.end(), {{0, 0}, at(i), at(i + 1)});
    }
    all.push_back(std::move(corners));
  }
  return all;
}

FitOptions at_scale(const test::ChartItems& charts, std::int32_t page_size, double scale) {
  FitOptions options = options_for(charts, page_size);
  options.max_scale = scale;
  return options;
}

TEST(FitAtScale, PagesAreAsFullAsTheirChartsAllowWhateverTheLargestSide) {
  for (const int count : {3, 16, 40, 200}) {
    SCOPED_TRACE(count);
    const test::ChartItems charts(ellipses(count));
    for (const std::int32_t page_size : {1024, 4096}) {
      const Result<FitResult> fit = fit_pages(charts.items, at_scale(charts, page_size, 1), {});
      ASSERT_TRUE(fit.ok());
      EXPECT_EQ(fit->scale, 1);
      EXPECT_GT(fit->utilization, 0.54);
      const auto [width, height] = fit->pages[0];
      EXPECT_LT(std::max(width, height), 1.4 * std::min(width, height));
      EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, 1), "");
      double area = 0;
      for (const std::vector<Vec2d>& c : charts.corners)
        for (std::size_t k = 0; k + 2 < c.size(); k += 3)
          area += (c[k + 1].x * c[k + 2].y - c[k + 2].x * c[k + 1].y) / 2;
      EXPECT_NEAR(fit->utilization, area / double(fit->pages[0].area()), 0.01);
    }
  }
}

TEST(FitAtScale, ChartsThatDoNotFitAtTheScaleFillThePage) {
  const test::ChartItems charts(ellipses(40));
  const Result<FitResult> free = fit_pages(charts.items, options_for(charts, 256), {});
  const Result<FitResult> bound = fit_pages(charts.items, at_scale(charts, 256, 1), {});
  ASSERT_TRUE(free.ok() && bound.ok());
  EXPECT_LT(bound->scale, 1);
  EXPECT_EQ(bound->scale, free->scale);
}

TEST(FitAtScale, LongChartsGetALongPage) {
  Shapes shapes = ellipses(3);
  shapes.push_back({{0, 0}, {900, 0}, {900, 20}, {0, 0}, {900, 20}, {0, 20}});
  const test::ChartItems charts(std::move(shapes));
  const Result<FitResult> fit = fit_pages(charts.items, at_scale(charts, 2048, 1), {});
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit->scale, 1);
  const auto [width, height] = fit->pages[0];
  EXPECT_LE(std::max(width, height), 1100) << "the short ones may lie beside it";
  EXPECT_LE(std::min(width, height), 90);
}

TEST(FitAtScale, MinimumSidesHold) {
  Shapes shapes = ellipses(20);
  shapes.push_back({{0, 0}, {2, 0}, {2, 1}});
  const test::ChartItems charts(std::move(shapes));
  FitOptions options = at_scale(charts, 1024, 0.5);
  options.minimum_side = 4;
  const Result<FitResult> fit = fit_pages(charts.items, options, {});
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit->scale, 0.5);
  EXPECT_EQ(fit->placements.back().scale, 0.5) << "no chart exceeds the largest scale";
  EXPECT_LT(std::max(fit->pages[0].width, fit->pages[0].height), 150);
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, 1), "");
}

TEST(FitAtScale, SidesAreMultiplesOfTheAlignment) {
  const test::ChartItems charts(ellipses(12));
  FitOptions options = at_scale(charts, 1000, 1);
  options.alignment = 8;
  const Result<FitResult> fit = fit_pages(charts.items, options, {});
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit->scale, 1);
  EXPECT_EQ(fit->pages[0].width % 8, 0);
  EXPECT_EQ(fit->pages[0].height % 8, 0);
  EXPECT_LT(std::max(fit->pages[0].width, fit->pages[0].height), 240);
}

TEST(FitAtScale, DoesNotDependOnThreads) {
  const test::ChartItems charts(ellipses(30));
  const FitOptions options = at_scale(charts, 2048, 1);
  const Result<FitResult> one = fit_pages(charts.items, options, Context{.threads = 1});
  const Result<FitResult> three = fit_pages(charts.items, options, Context{.threads = 3});
  ASSERT_TRUE(one.ok() && three.ok());
  test::expect_same(*one, *three);
}

// More than 128 charts are laid out anew on each page that has room to spare. Rectangles fill their
// first page so well that a smaller one follows.
TEST(FitAtScale, ProgressRises) {
  Shapes shapes;
  for (int k = 0; k < 160; ++k) {
    const double w = 40 + k % 16, h = 30 + k % 7;
    shapes.push_back({{0, 0}, {w, 0}, {w, h}, {0, 0}, {w, h}, {0, h}});
  }
  const test::ChartItems charts(std::move(shapes));
  Context context{.threads = 1};
  std::vector<double> fractions{0};
  context.progress = [&](std::string_view, double fraction) { fractions.push_back(fraction); };
  ASSERT_TRUE(fit_pages(charts.items, at_scale(charts, 4096, 1), context).ok());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GT(fractions.size(), 10u);
  EXPECT_LE(fractions.back(), 1);
}

TEST(FitAtScale, CanBeCancelled) {
  const test::ChartItems charts(ellipses(40));
  std::atomic<bool> raised = false;
  int reports = 0;
  Context context{.threads = 1, .cancel = &raised};
  context.progress = [&](std::string_view, double) { raised = ++reports == 2; };
  const Result<FitResult> fit = fit_pages(charts.items, at_scale(charts, 4096, 1), context);
  EXPECT_EQ(fit.status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas
