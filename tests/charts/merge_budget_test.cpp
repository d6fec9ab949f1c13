// The work of merging, which is bounded in proportion to the size of a piece.
#include "libatlas/charts/merging/merge_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/merging/merge.h"
#include "tests/charts/coarse_shapes.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

Vec3f at(double radius, double turn, double height) {
  const double angle = 2 * std::numbers::pi * turn;
  return {static_cast<float>(radius * std::cos(angle)),
          static_cast<float>(radius * std::sin(angle)), static_cast<float>(height)};
}

// A wheel with shallow rectangular teeth, capped by fans around its two hubs.
Shape toothed_wheel(std::uint32_t teeth) {
  Shape shape;
  const std::uint32_t n = 4 * teeth;
  for (const double height : {0.0, 0.1}) {
    for (std::uint32_t i = 0; i < teeth; ++i) {
      shape.positions.push_back(at(1, i / double(teeth), height));
      shape.positions.push_back(at(1, (i + 0.5) / teeth, height));
      shape.positions.push_back(at(1.01, (i + 0.5) / teeth, height));
      shape.positions.push_back(at(1.01, (i + 1.0) / teeth, height));
    }
  }
  shape.positions.push_back({0, 0, 0});
  shape.positions.push_back({0, 0, 0.1f});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    for (const std::uint32_t v :
         {i, j, n + j, i, n + j, n + i, 2 * n, j, i, 2 * n + 1, n + i, n + j})
      shape.indices.push_back(v);
  }
  return shape;
}

// A flat cone of needles around its tip, with caps along its rim that are folded up and down, much
// lower than wide.
Shape fan_with_caps(std::uint32_t n) {
  Shape shape;
  shape.positions.push_back({0, 0, 0.2f});
  for (std::uint32_t i = 0; i < n; ++i) shape.positions.push_back(at(1, i / double(n), 0));
  for (std::uint32_t i = 0; i < n; ++i)
    shape.positions.push_back(at(1 + 1e-9, (i + 0.5) / n, -1e-9));
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t p = 1 + i, q = 1 + (i + 1) % n;
    for (const std::uint32_t v : {0u, p, q, p, p + n, q, q, p + n, q + n})
      shape.indices.push_back(v);
  }
  return shape;
}

struct Merged {
  MergeResult result;
  std::size_t slots = 0;
};

Merged merge_shape(const Shape& shape) {
  const Topology topology = topology_of(shape);
  const CellOptions options;
  Cells cells = grow_cells({topology, plan_cells(topology, options)}, options, {});
  const CoarseMesh mesh = build_coarse(topology, 40, cells);
  const std::vector<std::uint32_t> piece(mesh.cells.size(), 0);
  return {merge_cells(mesh, piece, {}, {}), mesh.slot_position.size()};
}

std::size_t chart_count(const Shape& shape) {
  const Mesh mesh(shape);
  const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
  EXPECT_TRUE(set.ok());
  return set->charts.size();
}

// The second limit, and half of it again for even mergers.
std::uint64_t most_work(std::size_t slots) {
  return 3 * (1000000 + 64 * slots);
}

TEST(MergeWork, OfAToothedWheelIsBounded) {
  const Merged merged = merge_shape(toothed_wheel(250));
  EXPECT_GT(merged.slots, 4000u);
  EXPECT_LT(merged.result.work, most_work(merged.slots));
  EXPECT_LT(chart_count(toothed_wheel(250)), 45u);
}

TEST(MergeWork, OfAFanWithCapsIsBounded) {
  const Merged merged = merge_shape(fan_with_caps(500));
  EXPECT_GT(merged.slots, 2000u);
  EXPECT_LT(merged.result.work, most_work(merged.slots));
  EXPECT_LT(chart_count(fan_with_caps(500)), 10u);
}

TEST(MergeWork, OfAnOrdinaryShapeIsSmall) {
  const Merged merged = merge_shape(torus(120, 60));
  EXPECT_GT(merged.result.work, 0u);
  EXPECT_LT(merged.result.work, 64 * merged.slots);
}

TEST(MergeBudget, TurnsThriftyAndThenAllowsFewerAndFewerMergers) {
  MergeBudget budget(1000);
  const auto spend = [&](int trials) {
    for (int i = 0; i < trials; ++i) budget.count_trial(2000);
  };
  EXPECT_FALSE(budget.thrifty());
  EXPECT_FALSE(budget.postpones(10000, 3));
  spend(600);
  EXPECT_TRUE(budget.thrifty());
  EXPECT_TRUE(budget.postpones(3, 1000));
  EXPECT_TRUE(budget.postpones(1000, 3));
  EXPECT_FALSE(budget.postpones(500, 1000));
  EXPECT_TRUE(budget.affords(1000, 3));
  spend(600);
  EXPECT_FALSE(budget.affords(1000, 3));
  EXPECT_TRUE(budget.affords(1000, 500));
  EXPECT_TRUE(budget.affords(60, 3));
  spend(4000);
  EXPECT_FALSE(budget.affords(1000, 500));
  EXPECT_TRUE(budget.affords(20, 30));
}

}  // namespace
}  // namespace atlas::test
