// Texel densities are relative: a common factor scales the uvs and changes nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libatlas/charts/relative_density.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

ChartSet dense_charts(const Shape& shape, const std::vector<float>& density,
                      const ChartOptions& options = {}) {
  const Mesh mesh(shape);
  MeshView view = mesh.view();
  view.density = density;
  Result<ChartSet> set = make_charts(view, options, {});
  EXPECT_TRUE(set.ok()) << set.status().message();
  return set.ok() ? std::move(*set) : ChartSet{};
}

// A density that doubles three times from the first triangle to the last.
std::vector<float> ramp(const Shape& shape) {
  std::vector<float> density;
  const auto n = static_cast<double>(shape.triangle_count());
  for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
    density.push_back(static_cast<float>(std::exp2(3 * static_cast<double>(t) / n)));
  }
  return density;
}

std::vector<float> times(std::vector<float> density, double factor) {
  for (float& d : density) d = static_cast<float>(d * factor);
  return density;
}

TEST(Density, APowerOfTwoOnlyScalesTheUvs) {
  for (const Shape& shape : {noisy(grid(20, 20), 0.01, 3), torus(24, 12), box(4)}) {
    const std::vector<float> density = ramp(shape);
    const ChartSet plain = dense_charts(shape, density);
    for (const int power : {-120, -61, -20, -1, 33, 90}) {
      const double factor = std::ldexp(1.0, power);
      const ChartSet scaled = dense_charts(shape, times(density, factor));
      ASSERT_EQ(scaled.triangle_uv, plain.triangle_uv) << shape.name << ' ' << power;
      EXPECT_EQ(scaled.distortion.stretch_l2, plain.distortion.stretch_l2) << power;
      EXPECT_EQ(scaled.distortion.uv_area, plain.distortion.uv_area * factor * factor) << power;
      EXPECT_EQ(scaled.seam_length, plain.seam_length) << power;
      for (std::size_t i = 0; i < plain.uvs.size(); ++i) {
        const Vec2d uv{plain.uvs[i].x * factor, plain.uvs[i].y * factor};
        ASSERT_EQ(scaled.uvs[i], uv) << shape.name << ' ' << power;
      }
    }
  }
}

TEST(Density, NoFactorCutsOrStretchesCharts) {
  const Shape shape = noisy(grid(20, 20), 0.01, 3);
  const ChartSet plain = dense_charts(shape, ramp(shape));
  for (const double factor : {1e-37, 1e-9, 1e-6, 0.3, 1e9, 1e36}) {
    const ChartSet scaled = dense_charts(shape, times(ramp(shape), factor));
    EXPECT_EQ(scaled.charts.size(), plain.charts.size()) << factor;
    EXPECT_NEAR(scaled.distortion.stretch_999, plain.distortion.stretch_999, 1e-5) << factor;
    EXPECT_NEAR(scaled.distortion.stretch_l2, plain.distortion.stretch_l2, 1e-6) << factor;
  }
  // Densities near the smallest float have few digits, but are as equal as others.
  for (const float density : {1e-44f, 1e-40f, 3e38f}) {
    const ChartSet even = dense_charts(shape, std::vector<float>(shape.triangle_count(), density));
    EXPECT_EQ(even.charts.size(), 1u) << density;
    EXPECT_GE(even.distortion.stretch_l2, 1 - 1e-9) << density;
  }
}

// Between powers of two, lengths and areas in uv are up to twice and four times those of the
// surface.
TEST(Density, FactorsBetweenPowersOfTwoJoinTheSameFragments) {
  for (const Shape& shape : {noisy(icosphere(3), 0.03, 5), noisy(torus(24, 10), 0.03, 4),
                             noisy(sphere(22, 12), 0.04, 3), noisy(icosphere(3), 0.05, 9)}) {
    const std::vector<float> even(shape.triangle_count(), 1);
    ChartOptions best;
    best.preset = ChartPreset::best;
    for (const ChartOptions& options : {ChartOptions{}, best}) {
      const ChartSet plain = dense_charts(shape, even, options);
      for (const double factor : {1.25, 1.9375}) {
        const ChartSet scaled = dense_charts(shape, times(even, factor), options);
        EXPECT_EQ(scaled.charts.size(), plain.charts.size()) << shape.name << ' ' << factor;
        EXPECT_EQ(scaled.triangle_chart, plain.triangle_chart) << shape.name << ' ' << factor;
      }
    }
  }
}

// A part of a mesh may get hardly any texels.
TEST(Density, AThinPartIsFlattenedLikeTheOthers) {
  const Shape one = noisy(grid(20, 20), 0.01, 3);
  const Shape both = together(one, moved(one, 1, {3, 0, 0}));
  std::vector<float> density(both.triangle_count(), 1);
  std::fill(density.begin() + std::ptrdiff_t(density.size() / 2), density.end(), 1e-8f);
  const ChartSet set = dense_charts(both, density);
  ASSERT_EQ(set.charts.size(), 2u);
  EXPECT_NEAR(set.charts[1].distortion.stretch_l2, set.charts[0].distortion.stretch_l2, 1e-5);
  EXPECT_NEAR(set.charts[1].distortion.stretch_999, set.charts[0].distortion.stretch_999, 1e-4);
}

TEST(Density, TheFactorIsThePowerOfTwoInTheMiddle) {
  const RelativeDensity relative = relative_density(std::vector{0x1p-30f, 0x1p-20f, 0x1.8p-10f});
  EXPECT_EQ(relative.factor, 0x1p-20);
  EXPECT_EQ(relative.values, (std::vector{0x1p-10f, 1.0f, 0x1.8p10f}));
  // Nothing brings the whole range of floats nearer to 1.
  for (const std::vector<float>& kept : {std::vector{0.5f, 3.0f}, {0x1p-149f, 0x1p127f}, {}}) {
    EXPECT_EQ(relative_density(kept).values, kept);
    EXPECT_EQ(relative_density(kept).factor, 1);
  }
}

}  // namespace
}  // namespace atlas::test
