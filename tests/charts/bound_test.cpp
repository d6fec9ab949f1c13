// The bound steers the merging: a wide one saves charts and seams, a narrow one lowers the stretch.
#include <gtest/gtest.h>

#include "tests/charts/invariance.h"

namespace atlas::test {
namespace {

ChartSet bounded(const Shape& shape, double max_stretch) {
  ChartOptions options;
  options.max_stretch = max_stretch;
  MeshView view;
  view.positions = shape.positions;
  view.indices = shape.indices;
  Result<ChartSet> made = make_charts(view, options, {});
  EXPECT_TRUE(made.ok()) << made.status().message();
  return made.ok() ? std::move(*made) : ChartSet{};
}

TEST(Bound, AWideOneSavesChartsAndANarrowOneStretch) {
  for (const Shape& shape : {sphere(96, 48), torus(96, 48), noisy(icosphere(4), 0.02, 3)}) {
    const ChartSet narrow = bounded(shape, 1.06), usual = bounded(shape, 1.25),
                   wide = bounded(shape, 2);
    EXPECT_LT(wide.charts.size(), narrow.charts.size()) << shape.name;
    EXPECT_LT(wide.seam_length, usual.seam_length) << shape.name;
    EXPECT_LT(usual.seam_length, narrow.seam_length) << shape.name;
    EXPECT_LT(narrow.distortion.stretch_l2, usual.distortion.stretch_l2) << shape.name;
    EXPECT_LE(narrow.distortion.stretch_999, 1.06 * (1 + 1e-6)) << shape.name;
    EXPECT_LE(wide.distortion.stretch_999, 2 * (1 + 1e-6)) << shape.name;
  }
}

TEST(Bound, WhatUnrollsNeedsFewChartsAtAnyBound) {
  for (const Shape& shape :
       {cylinder(48, 12), cylinder(60, 30), cylinder(200, 100, 1, 2), cylinder(60, 2, 1, 0.01),
        cone(48, 12, 0.4), cone(60, 30, 0.5), cone(200, 100, 0.5), cone(60, 30, 1.4)}) {
    const std::string name = shape.name + " of " + std::to_string(shape.triangle_count());
    const ChartSet usual = bounded(shape, 1.25), tight = bounded(shape, 1.001);
    EXPECT_LE(usual.charts.size(), 1u) << name;
    EXPECT_LE(usual.distortion.stretch_999, 1.001) << name;
    EXPECT_LE(tight.charts.size(), 2u) << name;
    EXPECT_LE(tight.distortion.stretch_999, 1.001 * (1 + 1e-6)) << name;
  }
}

}  // namespace
}  // namespace atlas::test
