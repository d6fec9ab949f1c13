// The distortion of a whole from that of its charts.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libatlas/charts/totals.h"

namespace atlas::test {
namespace {

Chart chart_of(double area, double l2, double linf) {
  Chart chart;
  Distortion& d = chart.distortion;
  d.surface_area = area;
  d.uv_area = 2 * area;
  d.stretch_l2 = l2;
  d.stretch_linf = linf;
  d.stretch_999 = linf - 0.25;
  d.conformal_mean = l2 + 1;
  d.conformal_max = linf + 1;
  d.area_min = 1 / linf;
  d.area_max = linf + 2;
  d.flips = 2;
  d.degenerate = 3;
  return chart;
}

// The mean squared stretch of the whole is that of all its area; its extremes are those of any
// chart, in any order.
TEST(Totals, AreThoseOfTheWholeArea) {
  const Chart large = chart_of(30, 1.25, 1.5), small = chart_of(10, 2, 4);
  for (const std::vector<Chart>& charts : {std::vector<Chart>{large, small}, {small, large}}) {
    const Distortion total = total_distortion(charts);
    EXPECT_DOUBLE_EQ(total.surface_area, 40);
    EXPECT_DOUBLE_EQ(total.uv_area, 80);
    EXPECT_DOUBLE_EQ(total.stretch_l2, std::sqrt((30 * 1.5625 + 10 * 4) / 40));
    EXPECT_DOUBLE_EQ(total.conformal_mean, (30 * 2.25 + 10 * 3) / 40);
    EXPECT_DOUBLE_EQ(total.stretch_linf, 4);
    EXPECT_DOUBLE_EQ(total.stretch_999, 3.75);
    EXPECT_DOUBLE_EQ(total.conformal_max, 5);
    EXPECT_DOUBLE_EQ(total.area_min, 0.25);
    EXPECT_DOUBLE_EQ(total.area_max, 6);
    EXPECT_EQ(total.flips, 4u);
    EXPECT_EQ(total.degenerate, 6u);
  }
}

TEST(Totals, OfChartsWithoutAreaAreThoseOfPerfectOnes) {
  for (const std::vector<Chart>& charts : {std::vector<Chart>{}, {Chart{}}}) {
    const Distortion total = total_distortion(charts);
    EXPECT_EQ(total.surface_area, 0);
    EXPECT_EQ(total.stretch_l2, 1);
    EXPECT_EQ(total.stretch_999, 1);
    EXPECT_TRUE(std::isfinite(total.conformal_mean));
  }
}

}  // namespace
}  // namespace atlas::test
