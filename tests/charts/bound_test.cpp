// The stretch bound steers the merging: a wide bound saves charts and seams, a narrow one lowers
// the stretch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/charts/chart_checks.h"
#include "tests/charts/invariance.h"

namespace atlas::test {
namespace {

ChartSet bounded(const Shape& shape, double max_stretch,
                 ChartPreset preset = ChartPreset::standard) {
  ChartOptions options;
  options.max_stretch = max_stretch;
  options.preset = preset;
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

// A ball with bumps as high as it is wide, closed and smooth.
Shape bumpy(double height) {
  Shape shape = sphere(64, 32);
  for (Vec3f& p : shape.positions) {
    const double by =
        1 + height * std::sin(5 * p.x + 1) * std::sin(5 * p.y) * std::sin(5 * p.z + 2);
    p = {float(by * p.x), float(by * p.y), float(by * p.z)};
  }
  return shape;
}

// What the coarse mesh refuses may lie flat within a wide bound.
TEST(Bound, GoesOnTradingStretchForSeams) {
  const Shape shape = bumpy(0.6);
  double seam = std::numeric_limits<double>::infinity();
  std::size_t charts = 0;
  for (const double bound : {1.1, 1.25, 1.5, 2.0, 3.0, 5.0}) {
    const ChartSet made = bounded(shape, bound);
    MeshView view;
    view.positions = shape.positions;
    view.indices = shape.indices;
    const ChartFindings found = check_charts(view, made);
    EXPECT_EQ(found.fault, "") << bound;
    EXPECT_LE(found.stretch_999, bound * (1 + 1e-6));
    EXPECT_LE(made.seam_length, 1.02 * seam) << bound;
    seam = std::min(seam, made.seam_length);
    charts = made.charts.size();
    EXPECT_LE(charts, bound < 2 ? 100u : 4u) << bound;
  }
  EXPECT_LE(charts, 3u);
}

Shape with_spikes(Shape shape, std::size_t every, float height) {
  for (std::size_t v = 0; v < shape.positions.size(); v += every) {
    for (float* x : {&shape.positions[v].x, &shape.positions[v].y, &shape.positions[v].z})
      *x *= 1 + height;
  }
  return shape;
}

// Charts of rough surfaces stretch more than merging allows with the default bound. Merging is
// greedy: with a wider bound, other charts are merged first, which can leave a few more in the end.
TEST(Bound, AWiderOneLeavesHardlyMoreChartsOfARoughSurface) {
  for (const Shape& shape :
       {noisy_along_normals(icosphere(4), 0.6), with_spikes(icosphere(4), 40, 0.3F),
        noisy_along_normals(torus(80, 28), 0.6)}) {
    std::vector<std::size_t> charts;
    for (const double bound : {1.25, 1.5, 2.0, 5.0}) {
      const ChartSet made = bounded(shape, bound);
      charts.push_back(made.charts.size());
      const std::size_t least = *std::min_element(charts.begin(), charts.end());
      EXPECT_LE(charts.back(), least + std::max<std::size_t>(2, least / 10))
          << shape.name << " " << bound;
      EXPECT_LE(made.distortion.stretch_999, bound * (1 + 1e-6)) << shape.name;
      EXPECT_EQ(made.distortion.flips, 0u) << shape.name;
    }
    EXPECT_LT(charts.back(), charts.front()) << shape.name;
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

// Merging knows little about charts with few triangles. They are tried again once they are flat.
TEST(Bound, CoarseMeshesTakeFewerChartsTheMoreIsTried) {
  std::size_t charts[3] = {0, 0, 0};  // of the presets fast, standard and best
  double seams[3] = {0, 0, 0};
  for (const Shape& shape :
       {torus(24, 12), noisy(icosphere(3), 0.03, 5), box(3), sphere(20, 10),
        noisy(torus(16, 10), 0.04, 2), noisy(torus(18, 9), 0.05, 7), noisy(icosphere(3), 0.05, 9),
        noisy(sphere(22, 12), 0.04, 3), noisy(torus(24, 10), 0.03, 4)}) {
    for (const ChartPreset preset : {ChartPreset::fast, ChartPreset::standard, ChartPreset::best}) {
      const ChartSet made = bounded(shape, 1.25, preset);
      const auto i = static_cast<std::size_t>(preset);
      charts[i] += made.charts.size();
      seams[i] += made.seam_length;
      EXPECT_LE(made.distortion.stretch_999, 1.25 * (1 + 1e-6)) << shape.name;
      EXPECT_LE(made.distortion.stretch_l2, 1.01) << shape.name;
      EXPECT_EQ(made.distortion.flips, 0u) << shape.name;
    }
  }
  EXPECT_LT(seams[2], seams[0]);
  EXPECT_LT(charts[1], charts[0]);
  EXPECT_LT(charts[2], charts[1]);
}

TEST(Bound, OfSeveralAttemptsTheBestIsTakenPieceByPiece) {
  std::size_t alone[2] = {0, 0};  // of the presets standard and best
  Shape all;
  double place = 0;
  for (const Shape& shape :
       {noisy(torus(96, 48), 0.02, 1), noisy(icosphere(5), 0.01, 2),
        noisy(sphere(96, 60), 0.005, 3), noisy(torus(80, 60, 1, 0.5), 0.02, 4)}) {
    alone[0] += bounded(shape, 1.25).charts.size();
    alone[1] += bounded(shape, 1.25, ChartPreset::best).charts.size();
    all = all.positions.empty() ? shape : together(all, moved(shape, 1, {place += 4, 0, 0}));
  }
  EXPECT_LT(alone[1], alone[0]);
  // Together the shapes can take fewer charts, because one attempt may absorb charts that another
  // leaves. Each can also take one more, because the cells of a larger mesh are larger.
  const std::size_t joint = bounded(all, 1.25, ChartPreset::best).charts.size();
  EXPECT_LE(joint, alone[1] + 4);
  EXPECT_LT(joint, bounded(all, 1.25).charts.size());
}

}  // namespace
}  // namespace atlas::test
