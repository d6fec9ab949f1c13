// Strips whose length alone would determine the length of a page.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// Returns a lower bound of the page's area: the longest chart times the width of the widest other
// one.
double least_page(const ChartSet& set) {
  double longest = 0, page = 0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < set.charts.size(); ++k) {
    const double length = std::max(set.charts[k].size.x, set.charts[k].size.y);
    if (length > longest) at = k;
    longest = std::max(longest, length);
  }
  for (std::size_t k = 0; k < set.charts.size(); ++k) {
    const double width = std::min(set.charts[k].size.x, set.charts[k].size.y);
    if (k != at) page = std::max(page, longest * width);
  }
  return page;
}

TEST(LongCharts, AreCutForAPageThatTheRestFills) {
  const Mesh mesh(together(grid(9, 9), moved(grid(60, 2, 6, 0.05), 1, {0, 2, 0})));
  const ChartSet whole = checked_charts(mesh, 0),
                 cut = checked_charts(mesh, ChartOptions{}.min_fill);
  EXPECT_EQ(whole.charts.size(), 2u);
  EXPECT_GT(least_page(whole), 4 * whole.surface_area);
  EXPECT_LT(least_page(cut), 1.35 * cut.surface_area);
  EXPECT_EQ(cut.charts.size(), 5u);
  EXPECT_NEAR(cut.seam_length, 3 * 0.05, 0.01);
}

// The page is as high as the strip and the widest other chart together.
TEST(LongCharts, TakeARowOfThePage) {
  const Shape plate = grid(9, 9, 3.6f, 1.8f);
  const Mesh mesh(together(together(plate, moved(plate, 1, {5, 0, 0})),
                           moved(grid(70, 4, 14, 0.65f), 1, {0, 3, 0})));
  EXPECT_EQ(checked_charts(mesh, 0).charts.size(), 3u);
  EXPECT_EQ(checked_charts(mesh, ChartOptions{}.min_fill).charts.size(), 4u);
}

// Half of a hairpin's length consists of half of one arm and half of the other.
TEST(LongCharts, AreCutWhereTheyLieBesideThemselves) {
  constexpr int n = 48;
  Shape pin = grid(n, 3, 8, 0.3f);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t t = 0; t < pin.triangle_count(); ++t) {
    const int x = int(t / 2) % n, y = int(t / 2) / n;
    if ((y == 1 && x < n - 6) || (y == 2 && x < 12)) continue;
    kept.insert(kept.end(), &pin.indices[3 * t], &pin.indices[3 * t] + 3);
  }
  pin.indices = kept;
  const Mesh mesh(together(pin, moved(grid(9, 9, 3, 3), 1, {0, 2, 0})));
  const ChartSet whole = checked_charts(mesh, 0),
                 cut = checked_charts(mesh, ChartOptions{}.min_fill);
  EXPECT_EQ(whole.charts.size(), 2u);
  EXPECT_GT(cut.charts.size(), 2u);
  EXPECT_LT(least_page(cut), 0.7 * least_page(whole));
}

// On a page as long as the rod, gutters around tiny charts would take much of the area.
TEST(LongCharts, AreCutWhereGuttersWouldTakeThePage) {
  const Shape rod = grid(160, 2, 40, 0.5f);
  const auto page = [&](int specks) {
    Shape all = rod;
    for (int i = 0; i < specks; ++i) {
      all =
          together(all, moved(grid(2, 1, 0.3f, 0.2f), 1, {0.4 * (i % 99), 1 + 0.3 * (i / 99), 0}));
    }
    return Mesh(all);
  };
  EXPECT_EQ(checked_charts(page(60), ChartOptions{}.min_fill).charts.size(), 61u);
  const auto gutter = [](const ChartSet& set) {
    double around = 0, longest = 0;
    for (const Chart& chart : set.charts) {
      around += 2 * (chart.size.x + chart.size.y);
      longest = std::max(longest, chart.size.x);
    }
    return 1.3 * around * longest / 2048 / set.surface_area;
  };
  const Mesh many = page(420);
  const ChartSet whole = checked_charts(many, 0),
                 cut = checked_charts(many, ChartOptions{}.min_fill);
  EXPECT_GT(gutter(whole), 0.26);
  EXPECT_LT(gutter(cut), 0.26);
  EXPECT_EQ(cut.charts.size(), whole.charts.size() + 1);
}

// The columns of a rod of long triangles do not lie at even divisions of its length.
TEST(LongCharts, AreCutAlongTheShortestEdges) {
  const Mesh mesh(together(grid(7, 12, 24, 0.3), moved(grid(9, 9, 2, 2), 1, {0, 4, 0})));
  const ChartSet cut = checked_charts(mesh, ChartOptions{}.min_fill);
  ASSERT_GT(cut.charts.size(), 3u);
  EXPECT_NEAR(cut.seam_length, 0.3 * double(cut.charts.size() - 2), 1e-4);
}

TEST(LongCharts, StayWholeWhereOthersLeaveRoom) {
  for (const Shape& shape :
       {cylinder(200, 4, 1, 0.02),  // it is the only chart
        together(cylinder(80, 4, 1, 0.02), moved(grid(9, 9, 8, 8), 1, {4, 0, 0}))}) {
    const Mesh mesh(shape);
    EXPECT_EQ(checked_charts(mesh, 0.72).charts.size(), checked_charts(mesh, 0).charts.size())
        << shape.name;
  }
}

// No edge leads across a spike: its needles would come off one by one, each as long as the spike.
TEST(LongCharts, OfNeedlesStayWhole) {
  for (const int around : {24, 200}) {
    const Mesh spike(closed_cone(around, 30));
    EXPECT_LE(checked_charts(spike, ChartOptions{}.min_fill).charts.size(), 3u) << around;
  }
}

}  // namespace
}  // namespace atlas::test
