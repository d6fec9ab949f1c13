// Narrow gaps in charts are widened: what charts guarantee still holds, and nothing else changes.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "libatlas/charts/gaps.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

constexpr double kMostStretch = ChartOptions{}.max_stretch;

ChartSet kept_charts_of(const Mesh& mesh) {
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
  ChartSet set = kept_charts_of(mesh);
  for (Chart& chart : set.charts) {
    EXPECT_TRUE(chart.kept);
    chart.kept = false;
  }
  return set;
}

double surface_area(const ChartSet& set) {
  double area = 0;
  for (const Chart& chart : set.charts) area += chart.distortion.surface_area;
  return area;
}

// Returns the area that the triangles cover, computed from their corners.
double uv_area(const ChartSet& set) {
  double area = 0;
  for (std::size_t i = 0; i < set.triangle_uv.size(); i += 3) {
    const Vec2d p = set.uvs[set.triangle_uv[i]], q = set.uvs[set.triangle_uv[i + 1]],
                r = set.uvs[set.triangle_uv[i + 2]];
    area += 0.5 * std::abs((q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y));
  }
  return area;
}

GapReport measured(const MeshView& mesh, std::span<const double> clearance, const ChartSet& set) {
  const Result<GapReport> report = measure_gaps(mesh, clearance, set, {});
  EXPECT_TRUE(report.ok()) << report.status().message();
  return report.ok() ? *report : GapReport{};
}

GapReport widened(const MeshView& mesh, const GapLimits& limits, ChartSet& set,
                  const Context& context = {}) {
  const Result<GapReport> report = widen_gaps(mesh, limits, set, context);
  EXPECT_TRUE(report.ok()) << report.status().message();
  return report.ok() ? *report : GapReport{};
}

TEST(Gaps, ChartsKeepWhatTheyPromise) {
  std::size_t changed = 0;
  for (const Shape& shape : zoo()) {
    const Mesh mesh(shape);
    const ChartSet before = kept_charts_of(mesh);
    for (const double share : {0.01, 0.09}) {
      ChartSet set = before;
      const GapReport report = widened(mesh.view(), {clearances(set, share), kMostStretch}, set);
      changed += report.charts;
      EXPECT_LE(report.near_after, report.near_before * (1 + 1e-4)) << shape.name;
      const ChartFindings found = check_charts(mesh.view(), set);
      EXPECT_EQ(found.fault, "") << shape.name << ' ' << share;
      EXPECT_LE(found.stretch_999, kMostStretch * (1 + 1e-6)) << shape.name << ' ' << share;
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
  const GapReport before = measured(mesh.view(), clearance, set);
  ASSERT_GT(before.near_before, 1);
  const GapReport report = widened(mesh.view(), {clearance, kMostStretch}, set);
  EXPECT_EQ(report.charts, 1u);
  EXPECT_DOUBLE_EQ(report.near_before, before.near_before);
  const GapReport after = measured(mesh.view(), clearance, set);
  EXPECT_LT(after.near_before, 0.1 * before.near_before);
  const ChartFindings found = check_charts(mesh.view(), set);
  EXPECT_EQ(found.fault, "");
  EXPECT_NEAR(found.stretch_l2, set.distortion.stretch_l2, 1e-6);
  EXPECT_NEAR(found.stretch_999, set.distortion.stretch_999, 1e-4);
  EXPECT_NEAR(uv_area(set), surface_area(set), 1e-6);
  EXPECT_NEAR(set.distortion.uv_area, surface_area(set), 1e-6);
}

// Neither the unit nor a density that is the same everywhere changes what is reported.
TEST(Gaps, AreCountedInClearances) {
  constexpr double kLittle = 1.001;  // a bound that leaves most of the gaps
  const Mesh mesh = stairs(2);
  const ChartSet charts = flat_stairs(mesh);
  ChartSet set = charts;
  const GapReport one = widened(mesh.view(), {clearances(set, 0.05), kLittle}, set);
  ASSERT_GT(one.near_after, 0);
  Mesh large = mesh;
  for (Vec3f& p : large.positions) p = {8 * p.x, 8 * p.y, 8 * p.z};
  const std::vector<float> density(mesh.indices.size() / 3, 8.0f);
  MeshView dense = mesh.view();
  dense.density = density;
  for (const MeshView& view : {large.view(), dense}) {
    ChartSet scaled = charts;
    for (Vec2d& p : scaled.uvs) p = {8 * p.x, 8 * p.y};
    std::vector<double> clearance = clearances(charts, 0.05);
    for (double& c : clearance) c *= 8;
    for (Chart& chart : scaled.charts) {
      chart.size = {8 * chart.size.x, 8 * chart.size.y};
      chart.distortion.surface_area *= 64;
      chart.distortion.uv_area *= 64;
    }
    const GapReport report = widened(view, {clearance, kLittle}, scaled);
    EXPECT_EQ(report.charts, one.charts);
    EXPECT_NEAR(report.border, one.border, 1e-9 * one.border);
    EXPECT_NEAR(report.near_before, one.near_before, 1e-9 * one.near_before);
    EXPECT_NEAR(report.near_after, one.near_after, 1e-6 * one.near_before);
    for (std::size_t i = 0; i < set.uvs.size(); ++i) {
      ASSERT_NEAR(scaled.uvs[i].x, 8 * set.uvs[i].x, 1e-6);
      ASSERT_NEAR(scaled.uvs[i].y, 8 * set.uvs[i].y, 1e-6);
    }
  }
}

// Triangles that are turned against their chart, and triangles without area, are no obstacle.
TEST(Gaps, EndThoughTrianglesAreTurnedOrWithoutArea) {
  Mesh mesh = stairs(1);
  for (std::size_t i = 0; i + 3 < mesh.indices.size(); i += 9) {
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    std::swap(mesh.texcoord_indices[i + 1], mesh.texcoord_indices[i + 2]);
  }
  for (const std::uint32_t v : {0u, 0u, 1u, 3u, 3u, 3u}) {
    mesh.indices.push_back(v);
    mesh.texcoord_indices.push_back(v);
  }
  ChartSet set = flat_stairs(mesh);
  ASSERT_GT(set.flipped_triangles.size(), 0u);
  ASSERT_EQ(set.repairs.degenerate_triangles, 2u);
  EXPECT_EQ(widened(mesh.view(), {clearances(set, 0.05), kMostStretch}, set).charts, 1u);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
}

TEST(Gaps, WideningKeepsToTheBound) {
  const Mesh mesh = stairs(1);
  for (const double bound : {1.05, 1.1, 1.15}) {
    ChartSet set = flat_stairs(mesh);
    const double before = check_charts(mesh.view(), set).stretch_999;
    EXPECT_EQ(widened(mesh.view(), {clearances(set, 0.09), bound}, set).charts, 1u) << bound;
    const double after = check_charts(mesh.view(), set).stretch_999;
    EXPECT_GT(after, before + 0.5 * (bound - before)) << "the bound is made use of";
    EXPECT_LE(after, bound * (1 + 1e-6));
  }
}

TEST(Gaps, KeptChartsAndThoseOfNoInterestStay) {
  const Mesh mesh = stairs(1);
  const ChartSet before = flat_stairs(mesh);
  ChartSet set = before;
  const GapReport nothing = widened(mesh.view(), {clearances(set, 0), kMostStretch}, set);
  EXPECT_EQ(nothing.charts, 0u);
  EXPECT_EQ(nothing.border, 0);
  EXPECT_EQ(nothing.near_before, 0);
  EXPECT_EQ(nothing.near_after, 0);
  EXPECT_EQ(widened(mesh.view(), {clearances(set, 0.21), kMostStretch}, set).charts, 0u);
  EXPECT_EQ(measured(mesh.view(), clearances(set, 0.21), set).border, 0);
  EXPECT_GT(measured(mesh.view(), clearances(set, 0.19), set).border, 0);
  EXPECT_EQ(bytes(set), bytes(before));
  set.charts[0].kept = true;
  EXPECT_EQ(widened(mesh.view(), {clearances(set, 0.05), kMostStretch}, set).charts, 0u);
  set.charts[0].kept = false;
  EXPECT_EQ(bytes(set), bytes(before));
}

TEST(Gaps, MistakesAreErrorsAndChangeNothing) {
  const Mesh mesh = stairs(1), other = stairs(2);
  const ChartSet before = flat_stairs(mesh);
  ChartSet set = before;
  const std::vector<double> clearance = clearances(set, 0.05), none;
  const auto code = [](const Result<GapReport>& report) { return report.status().code(); };
  EXPECT_EQ(code(measure_gaps(other.view(), clearance, set, {})), ErrorCode::bad_input);
  EXPECT_EQ(code(measure_gaps(mesh.view(), none, set, {})), ErrorCode::bad_input);
  EXPECT_EQ(code(widen_gaps(other.view(), {clearance, kMostStretch}, set, {})),
            ErrorCode::bad_input);
  EXPECT_EQ(code(widen_gaps(mesh.view(), {none, kMostStretch}, set, {})), ErrorCode::bad_input);
  for (const double bound : {1.0, -2.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(code(widen_gaps(mesh.view(), {clearance, bound}, set, {})), ErrorCode::bad_option);
  std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  EXPECT_EQ(code(measure_gaps(mesh.view(), clearance, set, context)), ErrorCode::cancelled);
  EXPECT_EQ(code(widen_gaps(mesh.view(), {clearance, kMostStretch}, set, context)),
            ErrorCode::cancelled);
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
        widened(mesh.view(), {clearances(set, 0.05), kMostStretch}, set, context);
    EXPECT_GT(report.charts, 5u);
    if (threads == 1) one = bytes(set);
    EXPECT_EQ(bytes(set), one) << threads;
  }
}

}  // namespace
}  // namespace atlas::test
