// Strips that alone would decide how long a page is.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

ChartSet charts_of(const Mesh& mesh, double min_fill) {
  ChartOptions options;
  options.min_fill = min_fill;
  Result<ChartSet> set = make_charts(mesh.view(), options, {});
  EXPECT_TRUE(set.ok());
  EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
  return std::move(*set);
}

// Of the longest chart by the widest other one: no page is smaller.
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
  const ChartSet whole = charts_of(mesh, 0), cut = charts_of(mesh, ChartOptions{}.min_fill);
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
  EXPECT_EQ(charts_of(mesh, 0).charts.size(), 3u);
  EXPECT_EQ(charts_of(mesh, ChartOptions{}.min_fill).charts.size(), 4u);
}

// Half of a hairpin's length is half of one arm and half of the other.
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
  const ChartSet whole = charts_of(mesh, 0), cut = charts_of(mesh, ChartOptions{}.min_fill);
  EXPECT_EQ(whole.charts.size(), 2u);
  EXPECT_GT(cut.charts.size(), 2u);
  EXPECT_LT(least_page(cut), 0.7 * least_page(whole));
}

TEST(LongCharts, StayWholeWhereOthersLeaveRoom) {
  for (const Shape& shape :
       {cylinder(200, 4, 1, 0.02),  // it is alone
        together(cylinder(80, 4, 1, 0.02), moved(grid(9, 9, 8, 8), 1, {4, 0, 0}))}) {
    const Mesh mesh(shape);
    EXPECT_EQ(charts_of(mesh, 0.72).charts.size(), charts_of(mesh, 0).charts.size()) << shape.name;
  }
}

}  // namespace
}  // namespace atlas::test
