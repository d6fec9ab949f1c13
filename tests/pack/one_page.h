// Internal: charts for tests of one page.
#pragma once

#include <vector>

#include "libatlas/pack/fit.h"
#include "tests/pack/checks.h"

namespace atlas::test {

inline std::vector<Vec2d> box(double width, double height) {
  return {{0, 0}, {width, 0}, {width, height}, {0, 0}, {width, height}, {0, height}};
}

// Returns options for one page of any shape, with a texel between charts.
inline FitOptions options_for(const ChartItems& charts, int page_size) {
  FitOptions o;
  o.page_size = page_size;
  o.padding = o.alignment = 1;
  o.minimum_side = 0;
  o.max_scale = 100;
  o.free_aspect = true;
  o.shapes = charts.shapes;
  return o;
}

}  // namespace atlas::test
