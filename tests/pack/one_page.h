// Internal: charts for tests of one page.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "libatlas/pack/fitting/fit_search.h"
#include "tests/support/layout_checks.h"

namespace atlas::test {

inline std::vector<Vec2d> box(double width, double height) {
  return {{0, 0}, {width, 0}, {width, height}, {0, 0}, {width, height}, {0, height}};
}

// Returns options for one page of any shape, with a texel between charts.
inline pack::FitSearchOptions options_for(const ChartItems& charts, int page_size) {
  pack::FitSearchOptions o;
  o.page_size = page_size;
  o.padding = o.alignment = 1;
  o.minimum_side = 0;
  o.max_scale = 100;
  o.free_aspect = true;
  o.shapes = charts.shapes;
  return o;
}

// One page as it is pressed, on one thread and on three, and as the search over cells fills it.
struct PressedOnThreads {
  Result<FitResult> pressed, again, cells;
};
inline PressedOnThreads press_and_fill(const ChartItems& charts, FitOptions options) {
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  FitOptions by_cells = options;
  options.any_angle = true;
  by_cells.any_angle = false;
  return {fit_pages(charts.items, options, one), fit_pages(charts.items, options, three),
          fit_pages(charts.items, by_cells, one)};
}

// Expects the same pages, and every chart at the same place.
inline void expect_same(const FitResult& a, const FitResult& b) {
  EXPECT_EQ(a.pages, b.pages);
  ASSERT_EQ(a.placements.size(), b.placements.size());
  for (std::size_t i = 0; i < a.placements.size(); ++i) {
    EXPECT_EQ(a.placements[i].angle, b.placements[i].angle);
    EXPECT_EQ(a.placements[i].box, b.placements[i].box);
  }
}

}  // namespace atlas::test
