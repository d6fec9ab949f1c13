#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <string_view>

#include "libatlas/charts/cut_pieces.h"
#include "libatlas/charts/mesh/pieces.h"
#include "libatlas/charts/segment.h"
#include "libatlas/core/parallel.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// Parts that touch at corners, with their triangles in random order, one of them without area.
Mesh shuffled_parts() {
  Shape all = box(2);
  all = together(all, moved(box(1), 1, {1, 1, 1}));
  all = together(all, moved(cylinder(7, 1), 0.5, {9, 0, 0}));
  all = together(all, moved(grid(2, 3), 1, {0, 7, 0}));
  std::vector<std::uint32_t> order(all.triangle_count());
  for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  Mesh mesh(all);
  mesh.indices.clear();
  for (const std::uint32_t t : order) {
    for (int c = 0; c < 3; ++c) mesh.indices.push_back(all.indices[3 * t + c]);
  }
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1});
  return mesh;
}

std::vector<std::uint32_t> from_to(std::uint32_t first, std::uint32_t last) {
  std::vector<std::uint32_t> pieces;
  for (std::uint32_t k = first; k < last; ++k) pieces.push_back(k);
  return pieces;
}

TEST(Pieces, AreTheWholeMeshRenamed) {
  const Mesh mesh = shuffled_parts();
  Result<Topology> built = build_topology(mesh.view(), {}, {});
  ASSERT_TRUE(built.ok());
  Topology& whole = *built;
  ASSERT_EQ(whole.component_count, 4u);
  for (std::uint32_t t = 0; t < whole.triangle_count(); ++t) {
    whole.calm_normals.push_back({float(t), 0, 0});
    if (t % 5 == 0) whole.flags[t] |= Topology::kFlipped;
  }
  PieceCutter cutter(whole);
  for (const auto& [first, last] : {std::pair{0u, 2u}, {2u, 3u}, {1u, 4u}, {0u, 4u}}) {
    const PieceMesh part = cutter.cut(from_to(first, last));
    const Topology& t = part.topology;
    std::size_t expected = 0;
    for (const std::uint32_t k : whole.component) expected += k >= first && k < last;
    ASSERT_EQ(t.triangle_count(), expected);
    EXPECT_EQ(t.component_count, last - first);
    EXPECT_EQ(t.scale, whole.scale);
    EXPECT_EQ(t.whole_triangles, whole.triangle_count());
    for (std::uint32_t i = 0; i < expected; ++i) {
      const std::uint32_t w = part.triangles[i];
      EXPECT_EQ(t.component[i] + first, whole.component[w]);
      EXPECT_EQ(t.normals[i], whole.normals[w]);
      EXPECT_EQ(t.calm_normals[i], whole.calm_normals[w]);
      EXPECT_EQ(t.areas[i], whole.areas[w]);
      EXPECT_EQ(t.flags[i], whole.flags[w]);
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t h = 3 * i + c, v = t.corner_vertex[h];
        ASSERT_LT(v, t.points.size());
        EXPECT_EQ(t.points[v], whole.points[whole.corner_vertex[3 * w + c]]);
        EXPECT_EQ(t.source_vertex[v], whole.corner_vertex[3 * w + c]);
        const std::uint32_t o = t.opposite[h], across = whole.opposite[3 * w + c];
        ASSERT_EQ(o == kNoIndex, across == kNoIndex);
        if (o == kNoIndex) continue;
        EXPECT_EQ(3 * part.triangles[o / 3] + o % 3, across);
      }
      if (i > 0 && t.component[i] == t.component[i - 1]) {
        EXPECT_LT(part.triangles[i - 1], w);
      }
    }
  }
}

TEST(Pieces, ShareNoVertices) {
  const Mesh mesh = shuffled_parts();
  const Result<Topology> built = build_topology(mesh.view(), {}, {});
  ASSERT_TRUE(built.ok());
  const PieceMesh part = PieceCutter(*built).cut(from_to(0, 4));
  std::vector<std::uint32_t> owner(part.topology.points.size(), kNoIndex);
  for (std::uint32_t h = 0; h < part.topology.corner_vertex.size(); ++h) {
    std::uint32_t& k = owner[part.topology.corner_vertex[h]];
    if (k == kNoIndex) k = part.topology.component[h / 3];
    EXPECT_EQ(k, part.topology.component[h / 3]);
  }
  EXPECT_EQ(std::count(owner.begin(), owner.end(), kNoIndex), 0);
}

// There are more triangles than are cut at a time, and no part equals another.
Mesh many_parts() {
  Shape all;
  for (int i = 0; i < 1200; ++i) {
    const double x = i % 40, y = i / 40;
    const Shape part = i % 3 == 0 ? box(2) : cylinder(i % 3 == 1 ? 12 : 8, 2);
    for (const std::uint32_t v : part.indices)
      all.indices.push_back(std::uint32_t(all.positions.size()) + v);
    for (const Vec3f& p : part.positions)
      all.positions.push_back(
          {float(p.x + 4 * x), float(p.y + 4 * y), float(p.z * (1 + 0.001 * i))});
  }
  return Mesh(all);
}

TEST(Pieces, ManyBecomeChartsInParallel) {
  const Mesh mesh = many_parts();
  ASSERT_GT(mesh.indices.size(), 3 * 50000u);
  std::string one;
  for (const int threads : {1, 3}) {
    Context context;
    context.threads = threads;
    std::atomic<int> inside{0};
    double last = -1;
    int reports = 0;
    context.progress = [&](std::string_view stage, double fraction) {
      EXPECT_EQ(++inside, 1);
      EXPECT_EQ(stage, "charts");
      EXPECT_GE(fraction, last);
      EXPECT_LE(fraction, 1);
      last = fraction;
      ++reports;
      --inside;
    };
    const double start = own_cpu_seconds();
    const Result<ChartSet> set = make_charts(mesh.view(), {}, context);
    const double spent = own_cpu_seconds() - start;
    ASSERT_TRUE(set.ok());
    EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
    EXPECT_EQ(set->copied_pieces, 0u);
    EXPECT_LE(set->charts.size(), 6 * 1200u);
    EXPECT_GE(set->charts.size(), 1200u);
    EXPECT_GE(reports, 4);
    EXPECT_EQ(last, 1);
    EXPECT_NEAR(set->timing.segmentation_cpu + set->timing.parameterization_cpu, spent, 5e-3);
    EXPECT_GT(set->timing.segmentation_cpu, 0.1 * spent);
    EXPECT_GT(set->timing.parameterization_cpu, 0.1 * spent);
    if (one.empty()) one = bytes(*set);
    EXPECT_EQ(bytes(*set), one);
  }
}

TEST(Pieces, InParallelEndWhenCancelled) {
  const Mesh mesh = many_parts();
  std::atomic<bool> cancel{false};
  Context context;
  context.threads = 3;
  context.cancel = &cancel;
  context.progress = [&](std::string_view, double fraction) { cancel = fraction > 0.1; };
  const Result<ChartSet> set = make_charts(mesh.view(), {}, context);
  ASSERT_FALSE(set.ok());
  EXPECT_EQ(set.status().code(), ErrorCode::cancelled);
}

// ChartPreset::best tries several times. Charts that were divided in attempts that were given up do
// not count.
TEST(Pieces, SplitsAreThoseOfTheAttemptTaken) {
  ChartOptions options;
  options.preset = ChartPreset::best;
  const Mesh mesh(noisy(torus(48, 24), 0.06, 3));
  const Result<Topology> topology = build_topology(mesh.view(), {}, {});
  ASSERT_TRUE(topology.ok());
  ASSERT_EQ(topology->component_count, 1u);
  std::size_t fewest = kNoIndex;
  std::set<std::uint64_t> wanted;  // of the attempts with the fewest charts
  std::uint64_t all = 0;
  for (const double first_seed : {0.0, 0.25, 0.5, 0.75}) {
    Segmentation attempt = segment(*topology, options, first_seed, {});
    const FlattenResult flat =
        flatten_charts({*topology, {}, options, attempt.frames}, attempt.partition, {});
    all += flat.split_charts();
    if (flat.charts.size() > fewest) continue;
    if (flat.charts.size() < fewest) wanted.clear();
    fewest = flat.charts.size();
    wanted.insert(flat.split_charts());
  }
  ASSERT_GT(all, *wanted.rbegin()) << "other attempts divide charts, too";
  Frames none;
  const CutCharts cut = cut_pieces({*topology, {}, options, none}, from_to(0, 1), {});
  EXPECT_EQ(cut.charts.size(), fewest);
  EXPECT_TRUE(wanted.contains(cut.split_charts));
}

}  // namespace
}  // namespace atlas::test
