// Many charts on a page of any shape, on one of given shape, and on several pages.
#include "libatlas/pack/fitting/fit_many.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "tests/pack/one_page.h"
#include "tests/support/layout_checks.h"

namespace atlas {
namespace {

using namespace pack;
using test::options_for;
using Shapes = std::vector<std::vector<Vec2d>>;

constexpr int kMany = kManyOnPage;

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
  EXPECT_EQ(fit->pages.size(), options.pages);
  for (const Extent& page : fit->pages) {
    EXPECT_LE(page.width, options.page_size);
    EXPECT_LE(page.height, options.page_size);
  }
  return *fit;
}

FitOptions given_pages(const test::ChartItems& charts, std::uint32_t pages) {
  FitOptions options = options_for(charts, 1024);
  options.free_aspect = false;
  options.pages = pages;
  return options;
}

TEST(FitMany, PairsTrianglesThatBoxesHalfFill) {
  const test::ChartItems charts(triangles(kMany, 40, 30));
  FitOptions options = options_for(charts, 1024);
  EXPECT_GT(fitted(charts, options).utilization, 0.72);
  options.any_angle = false;  // each alone: their gaps are triangles that none fits
  EXPECT_LT(fitted(charts, options).utilization, 0.6);
}

TEST(FitMany, FillsThePageWithChartsOfAllSizes) {
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

TEST(FitMany, HoldsEveryPresetAndTurn) {
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

TEST(FitMany, StopsAtTheLargestScale) {
  const test::ChartItems charts(triangles(kMany, 40, 30));
  FitOptions options = options_for(charts, 2048);
  options.max_scale = 0.5;
  const FitResult fit = fitted(charts, options);
  EXPECT_EQ(fit.scale, 0.5);
  EXPECT_EQ(fit.packings, 1u);
}

TEST(FitMany, DoesNotDependOnThreads) {
  const test::ChartItems charts(blobs(2 * kMany));
  for (const FitOptions& options :
       std::vector<FitOptions>{options_for(charts, 512), given_pages(charts, 2)}) {
    const Result<FitResult> one = fit_pages(charts.items, options, Context{.threads = 1});
    const Result<FitResult> three = fit_pages(charts.items, options, Context{.threads = 3});
    ASSERT_TRUE(one.ok() && three.ok());
    test::expect_same(*one, *three);
  }
}

TEST(FitMany, FillsOnePageOrSeveralOfGivenShape) {
  for (const std::uint32_t pages : {1u, 3u}) {
    SCOPED_TRACE(pages);
    const test::ChartItems charts(triangles(kMany * int(pages), 40, 30));
    FitOptions options = given_pages(charts, pages);
    const FitResult fit = fitted(charts, options);
    EXPECT_GT(fit.utilization, 0.68);
    for (const Extent& page : fit.pages) EXPECT_EQ(page, (Extent{1024, 1024}));
    std::vector<double> on(pages);
    for (const FitPlacement& p : fit.placements) on[p.page] += 600 * fit.scale * fit.scale;
    for (const double area : on) EXPECT_NEAR(area / (1024.0 * 1024), fit.utilization, 0.01);
    options.any_angle = false;
    EXPECT_LT(fitted(charts, options).utilization, 0.6) << "without pairs";
  }
}

TEST(FitMany, CropsPagesThatAreNoPowersOfTwo) {
  const test::ChartItems charts(triangles(2 * kMany, 40, 30));
  FitOptions options = given_pages(charts, 2);
  options.power_of_two = false;
  options.page_size = 1000;
  const FitResult fit = fitted(charts, options);
  std::vector<Extent> used(2);
  for (const FitPlacement& p : fit.placements) {
    used[p.page].width = std::max(used[p.page].width, p.box.right());
    used[p.page].height = std::max(used[p.page].height, p.box.top());
  }
  EXPECT_EQ(fit.pages, used);
}

// The largest scale decides, so pages become fewer and smaller rather than charts larger.
TEST(FitMany, LeavesPagesThatAreNotNeeded) {
  const test::ChartItems charts(triangles(3 * kMany, 40, 30));
  FitOptions options = given_pages(charts, 3);
  options.max_scale = fitted(charts, options).scale / 4;
  const Result<FitResult> fit = fit_pages(charts.items, options, {});
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit->scale, options.max_scale);
  EXPECT_EQ(fit->pages.size(), 1u);
}

TEST(FitMany, TellsTheGroupsOfSeveralPages) {
  const test::ChartItems charts(triangles(2 * kMany, 40, 30));
  const FitResult fit = fitted(charts, given_pages(charts, 2));
  ASSERT_EQ(fit.grouping.group.size(), charts.items.size());
  std::vector<std::int64_t> area(2);
  for (std::size_t i = 0; i < charts.items.size(); ++i)
    area[fit.grouping.group[i]] += fit.placements[i].box.area();
  EXPECT_LE(double(std::max(area[0], area[1])), double(fit.grouping.capacity));
}

TEST(FitMany, IsGivenUpIfGuttersTakeIt) {
  const test::ChartItems charts(triangles(kMany, 40, 30));
  FitOptions options = options_for(charts, 64);
  options.padding = 2;
  EXPECT_EQ(fit_pages(charts.items, options, {}).status().code(), ErrorCode::no_solution);
}

TEST(FitMany, CanBeCancelled) {
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
