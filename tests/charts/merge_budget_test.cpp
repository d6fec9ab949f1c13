// The work of merging, which is bounded in proportion to the size of a piece.
#include "libatlas/charts/merging/merge_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/merging/merge.h"
#include "libatlas/charts/merging/trial_mesh.h"
#include "tests/charts/coarse_shapes.h"
#include "tests/charts/toothed_wheel.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// A flat cone of needles around its tip, with caps along its rim that are folded up and down, much
// lower than wide.
Shape fan_with_caps(std::uint32_t n) {
  Shape shape;
  shape.positions.push_back({0, 0, 0.2f});
  for (std::uint32_t i = 0; i < n; ++i) shape.positions.push_back(around_axis(1, i / double(n), 0));
  for (std::uint32_t i = 0; i < n; ++i)
    shape.positions.push_back(around_axis(1 + 1e-9, (i + 0.5) / n, -1e-9));
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
  EXPECT_LT(chart_count(toothed_wheel(250)), 10u);
}

TEST(MergeWork, OfAFanWithCapsIsBounded) {
  const Merged merged = merge_shape(fan_with_caps(500));
  EXPECT_GT(merged.slots, 2000u);
  EXPECT_LT(merged.result.work, most_work(merged.slots));
  EXPECT_LT(chart_count(fan_with_caps(500)), 4u);
}

// Cells that are sectors of a disc. The entries of the factor's rows, from the first to the
// diagonal, are counted.
TEST(MergeWork, OfSectorsAroundAHubGrowsWithTheirNumber) {
  constexpr std::uint32_t kSectors = 60, kNeedles = 10;
  const Topology topology = topology_of(fan(kSectors * kNeedles));
  Cells cells;
  cells.count = kSectors;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t)
    cells.of_triangle.push_back(t / kNeedles);
  const CoarseMesh mesh = build_coarse(topology, 40, cells);
  std::vector<std::uint8_t> joined(mesh.arcs.size(), 0);
  std::vector<std::uint32_t> glue;
  for (std::uint32_t arc = 0; arc < mesh.arcs.size(); ++arc) {
    joined[arc] = mesh.arcs[arc].cell[1] != kNoIndex;
    if (joined[arc]) glue.push_back(arc);
  }
  std::vector<std::uint32_t> sectors(mesh.cells.size());
  std::iota(sectors.begin(), sectors.end(), 0u);
  TrialScratch scratch(mesh);
  TrialMesh trial(mesh, scratch);
  trial.assemble({sectors, {}, glue}, joined);
  std::vector<std::uint32_t> first(trial.vertex_count());
  std::iota(first.begin(), first.end(), 0u);
  const JoinedFans fans = trial.fans();
  for (std::size_t c = 0; c < fans.cells.size(); ++c) {
    const auto own = fans.triangles.subspan(fans.first[c], fans.first[c + 1] - fans.first[c]);
    std::uint32_t low = kNoIndex;
    for (const JoinedFans::Triangle& t : own) low = std::min(low, t.a);
    for (const JoinedFans::Triangle& t : own) first[t.a] = std::min(first[t.a], low);
  }
  std::size_t entries = 0;
  for (std::size_t v = fans.cells.size(); v < first.size(); ++v) entries += v - first[v];
  const std::size_t rows = first.size() - fans.cells.size();
  EXPECT_EQ(rows, kSectors + 1);
  EXPECT_LT(entries, 5 * rows);
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
