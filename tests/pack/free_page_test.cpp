// Many charts on one page of any shape.
#include "libatlas/pack/fit_free_page.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "tests/pack/checks.h"
#include "tests/pack/one_page.h"

namespace atlas {
namespace {

using namespace pack;
using test::options_for;
using Shapes = std::vector<std::vector<Vec2d>>;

constexpr int kMany = kManyOnFreePage;

Shapes triangles(int count, double width, double height) {
  return Shapes(std::size_t(count), {{0, 0}, {width, 0}, {0, height}});
}

Shapes blobs(int count) {
  test::Noise noise{17};
  Shapes all;
  for (int k = 0; k < count; ++k)
    all.push_back(test::blob(noise, 5 + 20 * noise.unit(), noise.in(4, 11)));
  return all;
}

// Fits the charts, and expects that none overlaps another one or leaves the page.
FitResult fitted(const test::ChartItems& charts, const FitOptions& options) {
  const Result<FitResult> fit = fit_pages(charts.items, options, {});
  EXPECT_TRUE(fit.ok()) << fit.status().message();
  if (!fit.ok()) return {};
  EXPECT_EQ(test::check_outlines(test::placed_shapes(charts, *fit), fit->pages, options.padding),
            "");
  EXPECT_EQ(fit->pages.size(), 1u);
  EXPECT_LE(fit->pages[0].width, options.page_size);
  EXPECT_LE(fit->pages[0].height, options.page_size);
  return *fit;
}

TEST(FreePage, PairsTrianglesThatBoxesHalfFill) {
  const test::ChartItems charts(triangles(kMany, 40, 30));
  FitOptions options = options_for(charts, 1024);
  EXPECT_GT(fitted(charts, options).utilization, 0.72);
  options.any_angle = false;  // each alone: their gaps are triangles that none fits
  EXPECT_LT(fitted(charts, options).utilization, 0.6);
}

TEST(FreePage, FillsThePageWithChartsOfAllSizes) {
  const test::ChartItems charts(blobs(kMany));
  const FitOptions options = options_for(charts, 1024);
  const FitResult fit = fitted(charts, options);
  EXPECT_GT(fit.utilization, 0.55);
  EXPECT_LE(fit.packings, 4u);
  EXPECT_EQ(fit.placements.size(), charts.items.size());
  // The sum of the shapes' areas, by the shoelace formula, over that of the page.
  double area = 0;
  for (const std::vector<Vec2d>& c : charts.corners)
    for (std::size_t k = 0; k + 2 < c.size(); k += 3)
      area += 0.5 * std::abs((c[k + 1].x - c[k].x) * (c[k + 2].y - c[k].y) -
                             (c[k + 2].x - c[k].x) * (c[k + 1].y - c[k].y));
  EXPECT_NEAR(fit.utilization, fit.scale * fit.scale * area / double(fit.pages[0].area()), 0.01);
}

TEST(FreePage, HoldsEveryPresetAndTurn) {
  const test::ChartItems charts(blobs(kMany));
  double fast = 0;
  for (const PackPreset preset : {PackPreset::fast, PackPreset::standard, PackPreset::best}) {
    FitOptions options = options_for(charts, 1024);
    options.preset = preset;
    const double fill = fitted(charts, options).utilization;
    if (preset == PackPreset::fast) fast = fill;
    EXPECT_GE(fill, fast - 0.01);
  }
  FitOptions upright = options_for(charts, 1024);
  upright.allow_rotation = false;
  for (const FitPlacement& p : fitted(charts, upright).placements) EXPECT_EQ(p.angle, 0);
}

TEST(FreePage, StopsAtTheLargestScale) {
  const test::ChartItems charts(triangles(kMany, 40, 30));
  FitOptions options = options_for(charts, 2048);
  options.max_scale = 0.5;
  const FitResult fit = fitted(charts, options);
  EXPECT_EQ(fit.scale, 0.5);
  EXPECT_EQ(fit.packings, 1u);
}

TEST(FreePage, DoesNotDependOnThreads) {
  const test::ChartItems charts(blobs(kMany));
  const FitOptions options = options_for(charts, 512);
  const Result<FitResult> one = fit_pages(charts.items, options, Context{.threads = 1});
  const Result<FitResult> three = fit_pages(charts.items, options, Context{.threads = 3});
  ASSERT_TRUE(one.ok() && three.ok());
  test::expect_same(*one, *three);
}

TEST(FreePage, IsGivenUpIfGuttersTakeIt) {
  const test::ChartItems charts(triangles(kMany, 40, 30));
  FitOptions options = options_for(charts, 64);
  options.padding = 2;
  EXPECT_EQ(fit_pages(charts.items, options, {}).status().code(), ErrorCode::no_solution);
}

TEST(FreePage, CanBeCancelled) {
  const test::ChartItems charts(blobs(4 * kMany));
  std::atomic<bool> raised = false;
  int reports = 0;
  Context context{.threads = 1, .cancel = &raised};
  context.progress = [&](std::string_view, double) { raised = ++reports == 2; };
  const Result<FitResult> fit = fit_pages(charts.items, options_for(charts, 1024), context);
  EXPECT_EQ(reports, 2) << "nothing goes on after that";
  EXPECT_EQ(fit.status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas
