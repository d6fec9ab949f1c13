// Darts for charts whose stretch is worth a cut.
#include "libatlas/charts/flattening/relieve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/charts/whole_chart.h"

namespace atlas::test {
namespace {

FlatChart flattened(const Shape& shape, const ChartOptions& options = {}) {
  FlattenResult result = flatten_whole(shape, options);
  EXPECT_EQ(result.charts.size(), 1u);
  return std::move(result.charts.front());
}

struct Counts {
  int around, along;
};

// Rings around the vertex (0, 0, 0); the last ring is a circle around (`off`, 0). `height` returns
// the height at distance 1 for an angle.
template <class Height>
Shape rings(const char* name, Counts counts, double off, const Height& height) {
  const int around = counts.around, along = counts.along;
  Shape shape;
  shape.name = name;
  shape.positions.push_back({0, 0, 0});
  for (int j = 1; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double r = double(j) / along, angle = 2 * M_PI * i / around;
      const double x = r * (std::cos(angle) + off), y = r * std::sin(angle);
      shape.positions.push_back(
          {float(x), float(y), float(std::hypot(x, y) * height(std::atan2(y, x)))});
    }
  }
  const auto at = [&](int i, int j) {
    return j == 0 ? 0u : std::uint32_t(1 + (j - 1) * around + i % around);
  };
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < around; ++i) {
      shape.indices.insert(shape.indices.end(), {at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      if (j == 0) continue;
      shape.indices.insert(shape.indices.end(), {at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return shape;
}

// A cone whose tip lies near its border and lacks the angle `defect` (radians) of the full angle.
Shape cone_lacking(double defect, int around, int along) {
  const double cosine = 1 - defect / (2 * M_PI), height = std::sqrt(1 / (cosine * cosine) - 1);
  return rings("cone", {around, along}, 0.6, [&](double) { return height; });
}

// A saddle, whose middle has more than the full angle.
Shape saddle(int around, int along, double height) {
  return rings("saddle", {around, along}, 0, [&](double a) { return height * std::cos(2 * a); });
}

// With a dart to its tip, a cone is flat without stretch.
TEST(Relieve, ADartToTheTipFlattensACone) {
  for (const double defect : {0.95, 1.0, 1.1}) {
    for (const int around : {12, 30}) {
      for (const int along : {3, 10}) {
        const Shape shape = cone_lacking(defect, around, along);
        const FlatChart chart = flattened(shape);
        EXPECT_LT(chart.distortion.stretch_l2, 1 + 1e-5) << defect << ' ' << around;
        EXPECT_EQ(chart.uvs.size(), shape.positions.size() + std::size_t(along));
        EXPECT_EQ(chart.triangles.size(), shape.triangle_count());
        ChartOptions fast;
        fast.preset = ChartPreset::fast;
        const FlatChart closed = flattened(shape, fast);
        EXPECT_EQ(closed.uvs.size(), shape.positions.size());
        EXPECT_GT(closed.distortion.stretch_l2, 1 + 5e-4) << defect << ' ' << around;
      }
    }
  }
}

TEST(Relieve, WhatNoDartHelpsStaysWhole) {
  for (const Shape& shape : {saddle(24, 6, 0.25), saddle(40, 8, 0.35), cap(40, 10, 0.5)}) {
    const FlatChart chart = flattened(shape);
    EXPECT_GT(chart.distortion.stretch_l2, 1 + 1e-5) << shape.name;
    EXPECT_EQ(chart.uvs.size(), shape.positions.size()) << shape.name;
  }
}

// For a small defect, a dart as long as the cone costs more than the stretch that it removes.
TEST(Relieve, ADartMustBeWorthItsSeam) {
  const Shape shape = cone_lacking(0.1, 30, 10);
  const FlatChart chart = flattened(shape);
  EXPECT_GT(chart.distortion.stretch_l2, 1 + 1e-6);
  EXPECT_EQ(chart.uvs.size(), shape.positions.size());
}

// Energy and seams scale alike with the surface; the texel density must not enter into only one of
// them.
TEST(Relieve, AUniformDensityChangesNothing) {
  const Shape shape = cone_lacking(0.65, 30, 10);
  const Result<ChartSet> plain = make_charts({shape.positions, shape.indices}, {}, {});
  ASSERT_TRUE(plain.ok()) << plain.status().message();
  EXPECT_GT(plain->uvs.size(), shape.positions.size());  // there is a dart
  for (const float density : {1.0f / 64, 1.0f, 64.0f}) {
    const std::vector<float> densities(shape.triangle_count(), density);
    MeshView mesh{shape.positions, shape.indices};
    mesh.density = densities;
    const Result<ChartSet> set = make_charts(mesh, {}, {});
    ASSERT_TRUE(set.ok()) << set.status().message();
    EXPECT_EQ(set->charts.size(), 1u) << density;
    EXPECT_EQ(set->uvs.size(), plain->uvs.size()) << density;
    EXPECT_NEAR(set->distortion.stretch_l2, plain->distortion.stretch_l2, 1e-7) << density;
  }
}

}  // namespace
}  // namespace atlas::test
