// Narrow gaps in charts are widened: what charts guarantee still holds, and nothing else changes.
#include <gtest/gtest.h>

#include <cmath>

#include "libatlas/charts/gaps.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

constexpr double kMaxStretch = ChartOptions{}.max_stretch;

ChartSet charts_of(const Mesh& mesh) {
  ChartOptions options;
  options.keep_uv_charts = !mesh.texcoords.empty();
  auto charts = make_charts(mesh.view(), options, {});
  EXPECT_TRUE(charts.ok()) << charts.status().message();
  return std::move(*charts);
}

// Returns for each chart `share` times the square root of its area.
std::vector<double> clearances(const ChartSet& set, double share) {
  std::vector<double> clearance;
  for (const Chart& chart : set.charts)
    clearance.push_back(share * std::sqrt(chart.distortion.surface_area));
  return clearance;
}

// Returns turns of spiral stairs. The uvs of each lay it flat as a ring whose ends nearly meet.
Mesh stairs(int count) {
  constexpr double kArc = 6.25, kRise = 1;
  const Shape strip = grid(60, 6);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const Vec3f& p : strip.positions) {
      const double angle = kArc * p.x, r = (1 + 0.1 * i) * (1.4 - 0.4 * p.y);
      const double x = 4.0 * i + r * std::cos(angle), y = r * std::sin(angle);
      mesh.positions.push_back({float(x), float(y), float(kRise * p.x)});
      mesh.texcoords.push_back({float((x + 2) / 32), float((y + 2) / 32)});
    }
    for (const std::uint32_t v : strip.indices) mesh.indices.push_back(first + v);
  }
  mesh.texcoord_indices = mesh.indices;
  return mesh;
}

// Returns their charts, marked as if they had been flattened.
ChartSet flat_stairs(const Mesh& mesh) {
  ChartSet set = charts_of(mesh);
  for (Chart& chart : set.charts) {
    EXPECT_TRUE(chart.kept);
    chart.kept = false;
  }
  return set;
}

TEST(Gaps, ChartsKeepWhatTheyPromise) {
  std::size_t changed = 0;
  for (const Shape& shape : zoo()) {
    const Mesh mesh(shape);
    const ChartSet before = charts_of(mesh);
    for (const double share : {0.01, 0.09}) {
      ChartSet set = before;
      const GapReport report =
          widen_gaps(mesh.view(), {clearances(set, share), kMaxStretch}, set, {});
      changed += report.charts;
      EXPECT_LE(report.near_after, report.near_before) << shape.name;
      const ChartFindings found = check_charts(mesh.view(), set);
      EXPECT_EQ(found.fault, "") << shape.name << ' ' << share;
      EXPECT_LE(found.stretch_999, kMaxStretch * (1 + 1e-6)) << shape.name << ' ' << share;
      EXPECT_NEAR(found.stretch_l2, set.distortion.stretch_l2, 1e-3) << shape.name;
      EXPECT_NEAR(found.seam, before.seam_length, 1e-4 * (1 + found.seam)) << shape.name;
      EXPECT_EQ(set.triangle_uv, before.triangle_uv) << shape.name;
      if (report.charts == 0) {
        EXPECT_EQ(bytes(set), bytes(before)) << shape.name;
      }
    }
  }
  EXPECT_GT(changed, 0u);
}

TEST(Gaps, EndsOfAStairPart) {
  const Mesh mesh = stairs(1);
  ChartSet set = flat_stairs(mesh);
  ASSERT_EQ(set.charts.size(), 1u);
  const std::vector<double> clearance = clearances(set, 0.05);
  const GapReport before = measure_gaps(mesh.view(), clearance, set, {});
  ASSERT_GT(before.near_before, 1);
  const GapReport report = widen_gaps(mesh.view(), {clearance, kMaxStretch}, set, {});
  EXPECT_EQ(report.charts, 1u);
  EXPECT_DOUBLE_EQ(report.near_before, before.near_before);
  const GapReport after = measure_gaps(mesh.view(), clearance, set, {});
  EXPECT_LT(after.near_before, 0.1 * before.near_before);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
}

TEST(Gaps, KeptChartsAndThoseOfNoInterestStay) {
  const Mesh mesh = stairs(1);
  const ChartSet before = flat_stairs(mesh);
  ChartSet set = before;
  EXPECT_EQ(widen_gaps(mesh.view(), {clearances(set, 0), kMaxStretch}, set, {}).charts, 0u);
  EXPECT_EQ(widen_gaps(mesh.view(), {clearances(set, 0.21), kMaxStretch}, set, {}).charts, 0u);
  EXPECT_EQ(bytes(set), bytes(before));
  set.charts[0].kept = true;
  EXPECT_EQ(widen_gaps(mesh.view(), {clearances(set, 0.05), kMaxStretch}, set, {}).charts, 0u);
  set.charts[0].kept = false;
  EXPECT_EQ(bytes(set), bytes(before));
}

TEST(Gaps, SameBytesForAnyThreadCount) {
  const Mesh mesh = stairs(6);
  const ChartSet before = flat_stairs(mesh);
  std::string one;
  for (const int threads : {1, 2, 8}) {
    Context context;
    context.threads = threads;
    ChartSet set = before;
    const GapReport report =
        widen_gaps(mesh.view(), {clearances(set, 0.05), kMaxStretch}, set, context);
    EXPECT_GT(report.charts, 5u);
    if (threads == 1) one = bytes(set);
    EXPECT_EQ(bytes(set), one) << threads;
  }
}

}  // namespace
}  // namespace atlas::test
