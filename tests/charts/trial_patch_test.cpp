// An optimisation that is limited to the surroundings of a small chart that is joined to a large
// one.
#include "libatlas/charts/merging/trial_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/fan_solver.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/coarse_shapes.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

constexpr std::size_t kCells = 20;

// The cells of a spherical cap, flattened by many plain steps. Those of its eastern end are the
// second chart.
struct JoinedCap {
  CoarseMesh mesh = coarse_of(cap(60, 30, 1.2));
  TrialScratch scratch{mesh};
  TrialMesh trial{mesh, scratch};
  Fans fans{mesh};
  std::vector<Vec2d> uvs;

  JoinedCap() {
    std::vector<std::uint32_t> first, second, glue;
    std::vector<std::uint8_t> joined(mesh.arcs.size(), 0);
    const auto eastern = [&](std::uint32_t k) { return mesh.cells[k].centre.x > 0.75; };
    for (std::uint32_t k = 0; k < mesh.cells.size(); ++k)
      (eastern(k) ? second : first).push_back(k);
    for (std::uint32_t arc = 0; arc < mesh.arcs.size(); ++arc) {
      joined[arc] = mesh.arcs[arc].cell[1] != kNoIndex;
      if (joined[arc]) glue.push_back(arc);
    }
    trial.assemble({first, second, glue}, joined);
    uvs.resize(trial.vertex_count());
    for (const JoinedFans::Triangle& t : trial.triangles()) {
      const Vec3d a = mesh.slot_position[t.slot], c = mesh.cells[trial.cells()[t.centre]].centre;
      uvs[t.a] = {a.x, a.y};
      uvs[t.centre] = {c.x, c.y};
    }
    FanSolver whole(fans);
    whole.factorize(trial.fans(), uvs.size());
    for (int i = 0; i < 400; ++i) whole.step(1, uvs);
  }
  std::size_t second_count() const { return trial.cells().size() - trial.first_count(); }
};

TEST(TrialPatch, HoldsTheVerticesThatOtherCellsHave) {
  JoinedCap cap;
  ASSERT_GT(cap.trial.cells().size(), 2 * kCells);
  ASSERT_GT(cap.second_count(), 0u);
  ASSERT_LT(cap.second_count(), kCells / 2);
  TrialPatch patch;
  patch.take(cap.trial, kCells, cap.uvs);
  const JoinedFans own = patch.fans(), all = cap.trial.fans();
  const std::set<std::uint32_t> cells(own.cells.begin(), own.cells.end());
  EXPECT_EQ(cells.size(), kCells);
  for (std::size_t c = cap.trial.first_count(); c < all.cells.size(); ++c)
    EXPECT_TRUE(cells.count(all.cells[c])) << c;
  // The trial's vertex of each slot.
  std::vector<std::uint32_t> vertex(cap.mesh.slot_position.size());
  std::set<std::uint32_t> outside;
  for (const JoinedFans::Triangle& t : all.triangles) {
    vertex[t.slot] = t.a;
    if (!cells.count(all.cells[t.centre])) outside.insert(t.a);
  }
  std::size_t held = 0;
  std::set<std::uint32_t> seen;
  for (const JoinedFans::Triangle& t : own.triangles) {
    const std::uint32_t v = vertex[t.slot];
    EXPECT_EQ(patch.uvs()[t.a], cap.uvs[v]);
    EXPECT_EQ(t.a >= patch.first_held(), outside.count(v) > 0);
    if (seen.insert(v).second) held += t.a >= patch.first_held();
  }
  EXPECT_EQ(held, patch.uvs().size() - patch.first_held());
  EXPECT_EQ(seen.size() + kCells, patch.uvs().size());
  EXPECT_GT(held, 3u);
}

// From any position of its own vertices, the patch converges to where the optimisation of all cells
// had brought them.
TEST(TrialPatch, DescendsToWhereTheWholeCame) {
  JoinedCap cap;
  TrialPatch patch;
  patch.take(cap.trial, kCells, cap.uvs);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-0.02, 0.02);
  for (std::size_t v = 0; v < patch.first_held(); ++v) {
    Vec2d& uv = patch.uvs()[v];
    uv = {uv.x + off(random), uv.y + off(random)};
  }
  std::vector<Vec2d> moved = cap.uvs;
  patch.give_back(moved);
  EXPECT_NE(moved, cap.uvs);
  FanSolver solver(cap.fans);
  solver.factorize(patch.fans(), patch.first_held(), patch.uvs());
  const std::vector<Vec2d> start(patch.uvs().begin(), patch.uvs().end());
  for (int i = 0; i < 400; ++i) solver.step(1, patch.uvs());
  for (std::size_t v = patch.first_held(); v < start.size(); ++v)
    EXPECT_EQ(patch.uvs()[v], start[v]);
  patch.give_back(moved);
  for (std::size_t v = 0; v < moved.size(); ++v) {
    EXPECT_NEAR(moved[v].x, cap.uvs[v].x, 1e-6) << v;
    EXPECT_NEAR(moved[v].y, cap.uvs[v].y, 1e-6) << v;
  }
}

TEST(TrialPatch, IsAllOfWhatIsNoLarger) {
  JoinedCap cap;
  TrialPatch patch;
  patch.take(cap.trial, 1000, cap.uvs);
  EXPECT_EQ(patch.fans().cells.size(), cap.trial.cells().size());
  EXPECT_EQ(patch.first_held(), cap.uvs.size());
  FanSolver solver(cap.fans);
  solver.factorize(patch.fans(), patch.first_held(), patch.uvs());
  solver.step(1, patch.uvs());
  std::vector<Vec2d> moved = cap.uvs;
  patch.give_back(moved);
  // No vertex is held, so the patch may move as a whole.
  const Vec2d shift{moved[0].x - cap.uvs[0].x, moved[0].y - cap.uvs[0].y};
  for (std::size_t v = 0; v < moved.size(); ++v) {
    EXPECT_NEAR(moved[v].x - shift.x, cap.uvs[v].x, 1e-6) << v;
    EXPECT_NEAR(moved[v].y - shift.y, cap.uvs[v].y, 1e-6) << v;
  }
}

}  // namespace
}  // namespace atlas::test
