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

}  // namespace
}  // namespace atlas::test
