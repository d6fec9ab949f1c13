// Calls that take charts and a mesh refuse charts that contradict themselves or the mesh.
#include "libatlas/charts/chart_set_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "libatlas/charts/gaps.h"
#include "libatlas/charts/tiles.h"
#include "tests/charts/chart_checks.h"
#include "tests/support/broken_charts.h"

namespace atlas::test {
namespace {

struct Calls {
  Status check, measured, widened, cut;
};

Calls call_all(const MeshView& mesh, const ChartSet& set) {
  const std::vector<double> clearance(set.charts.size(), 0.02), sides(set.charts.size(), 0.3);
  ChartSet widened = set, cut = set;
  const Calls calls{check_chart_set(mesh, set, "test"),
                    measure_gaps(mesh, clearance, set, {}).status(),
                    widen_gaps(mesh, {clearance}, widened, {}).status(),
                    cut_to_limits(mesh, {sides}, cut, {}).status()};
  if (!calls.cut.ok()) {
    EXPECT_EQ(cut.uvs, set.uvs);
  }
  return calls;
}

TEST(ChartSetCheck, WhatMakeChartsReturnsPasses) {
  for (const Shape& shape : zoo()) {
    const Mesh mesh(shape);
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok()) << shape.name;
    const Status status = check_chart_set(mesh.view(), *set, "test");
    EXPECT_TRUE(status.ok()) << shape.name << ": " << status.message();
  }
}

TEST(ChartSetCheck, BrokenSetsAreBadInputForEveryCall) {
  const Mesh mesh(grid(20, 20));
  const ChartSet good = checked_charts(mesh);
  std::vector<BrokenCharts> all = broken_charts();
  for (const BrokenCharts& more : charts_with_broken_vertices()) all.push_back(more);
  for (const BrokenCharts& broken : all) {
    ChartSet set = good;
    broken.damage(set);
    const Calls calls = call_all(mesh.view(), set);
    for (const auto& [status, who] : {std::pair{calls.check, "test: "},
                                      {calls.measured, "gaps: "},
                                      {calls.widened, "gaps: "},
                                      {calls.cut, "tiles: "}}) {
      EXPECT_EQ(status.code(), ErrorCode::bad_input) << who << broken.what;
      EXPECT_TRUE(status.message().starts_with(who)) << broken.what << ": " << status.message();
    }
  }
  ChartSet set = good;
  set.triangle_uv[7] = 1000000;
  EXPECT_EQ(check_chart_set(mesh.view(), set, "test").message(),
            "test: triangle 2 uses uv 1000000 outside chart 0");
  set = good;
  set.triangle_chart.pop_back();
  EXPECT_EQ(call_all(mesh.view(), set).cut.code(), ErrorCode::bad_input);
}

// As many triangles as the mesh, but more vertices.
TEST(ChartSetCheck, ChartsOfAnotherMeshAreBadInput) {
  const Mesh mesh(grid(20, 20)), other(fan(800));
  ASSERT_EQ(mesh.indices.size(), other.indices.size());
  const Calls calls = call_all(mesh.view(), checked_charts(other));
  for (const Status& status : {calls.check, calls.measured, calls.widened, calls.cut}) {
    EXPECT_EQ(status.code(), ErrorCode::bad_input) << status.message();
  }
}

TEST(ChartSetCheck, MaterialsAndDensitiesAreOnePerTriangle) {
  const Mesh mesh(grid(20, 20));
  const ChartSet set = checked_charts(mesh);
  const auto expect = [&](const MeshView& view, const std::string& message) {
    const Calls calls = call_all(view, set);
    EXPECT_EQ(calls.check.message(), "test: " + message);
    for (const Status& status : {calls.check, calls.measured, calls.widened, calls.cut})
      EXPECT_EQ(status.code(), ErrorCode::bad_input) << message;
  };
  MeshView view = mesh.view();
  const std::vector<std::uint32_t> materials(799, 1);
  view.materials = materials;
  expect(view, "799 materials for 800 triangles (none, or 1 a triangle)");
  view = mesh.view();
  std::vector<float> density(3, 1);
  view.density = density;
  expect(view, "3 densities for 800 triangles (none, or 1 a triangle)");
  density.assign(800, 2);
  view.density = density;
  EXPECT_TRUE(check_chart_set(view, set, "test").ok());
  density[7] = 0;
  expect(view, "triangle 7: density 0 (must be above 0 and finite)");
  density[7] = std::numeric_limits<float>::infinity();
  expect(view, "triangle 7: density inf (must be above 0 and finite)");
}

TEST(ChartSetCheck, ClearancesAreNumbersFromZero) {
  const Mesh mesh(grid(20, 20));
  ChartSet set = checked_charts(mesh);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double clearance : {kNan, -1.0, -1e-300}) {
    const std::vector<double> all(set.charts.size(), clearance);
    EXPECT_EQ(measure_gaps(mesh.view(), all, set, {}).status().code(), ErrorCode::bad_input);
    EXPECT_EQ(widen_gaps(mesh.view(), {all}, set, {}).status().code(), ErrorCode::bad_input);
  }
  for (const double clearance : {0.0, 1e300, std::numeric_limits<double>::infinity()}) {
    const std::vector<double> all(set.charts.size(), clearance);
    EXPECT_TRUE(measure_gaps(mesh.view(), all, set, {}).ok()) << clearance;
  }
}

}  // namespace
}  // namespace atlas::test
