// Seams of a chart with itself are closed where both sides coincide, and only there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libatlas/charts/flattening/split.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

TEST(Slits, APlateWithHolesKeepsNone) {
  for (const int holes : {1, 2, 4}) {
    const Mesh mesh(plate_with_holes(holes, 6));
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok());
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges;
    for (std::uint32_t h = 0; h < mesh.indices.size(); ++h) {
      edges[std::minmax(mesh.indices[h], mesh.indices[next_half_edge(h)])].push_back(h);
    }
    for (const auto& [edge, sides] : edges) {
      if (sides.size() != 2) continue;
      const auto uv = [&](std::uint32_t h) { return set->triangle_uv[h]; };
      const std::uint32_t h = sides[0], o = sides[1];
      if (set->triangle_chart[h / 3] != set->triangle_chart[o / 3]) continue;
      if (uv(h) == uv(next_half_edge(o)) && uv(next_half_edge(h)) == uv(o)) continue;
      const auto gap = [&](std::uint32_t a, std::uint32_t b) {
        return std::hypot(set->uvs[a].x - set->uvs[b].x, set->uvs[a].y - set->uvs[b].y);
      };
      EXPECT_GT(gap(uv(h), uv(next_half_edge(o))) + gap(uv(next_half_edge(h)), uv(o)), 1e-7)
          << holes << " holes";
    }
  }
}

// A grid of 8 x 8 quads with a slit along x = 1/2 from y = 1/4 to 3/4, whose right side lies `gap`
// beside the left one.
TEST(Slits, BanksThatHaveChangedSidesAreFoundAndClosed) {
  const Mesh mesh(grid(8, 8));
  const Result<Topology> topology = build_topology(mesh.view(), {}, {});
  ASSERT_TRUE(topology.ok());
  for (const double gap : {0.05, -0.05}) {
    Partition partition;
    Darts darts, none;
    partition.chart.assign(topology->triangle_count(), 0);
    partition.seams.assign(topology->triangle_count(), 0);
    partition.local.resize(topology->triangle_count());
    std::vector<std::uint32_t> triangles(topology->triangle_count());
    const auto at = [&](std::uint32_t h) {
      return mesh.positions[topology->source_vertex[topology->corner_vertex[h]]];
    };
    for (std::uint32_t h = 0; h < topology->opposite.size(); ++h) {
      triangles[h / 3] = h / 3;
      const Vec3f a = at(h), b = at(next_half_edge(h));
      const bool cut = a.x == 0.5f && b.x == 0.5f && std::abs(a.y + b.y - 1) < 0.5f;
      if (!cut) continue;
      partition.cut(h);
      darts.cut.insert(std::min(h, topology->opposite[h]));
    }
    LocalChart chart;
    chart.build(*topology, partition, triangles);
    ASSERT_EQ(chart.loops.size(), 2u);
    std::vector<Vec2d> uvs(chart.positions.size());
    for (std::uint32_t h = 0; h < chart.opposite.size(); ++h) {
      const Vec3f p = at(h);
      const bool bank = p.x == 0.5f && std::abs(p.y - 0.5f) < 0.2f && h / 3 / 2 % 8 >= 4;
      uvs[chart.corners[h / 3][h % 3]] = {p.x + (bank ? gap : 0), p.y};
    }
    const std::vector<BorderCrossing> turned = turned_loops(chart, uvs);
    EXPECT_EQ(turned.size(), gap > 0 ? 0u : 8u);
    // Cuts that are not darts stay, because they may be what makes a chart a disc.
    EXPECT_FALSE(none.close_crossed(*topology, chart, turned, partition));
    EXPECT_TRUE(none.closed.empty());
    EXPECT_EQ(darts.close_crossed(*topology, chart, turned, partition), gap < 0);
    EXPECT_EQ(darts.closed.size(), gap > 0 ? 0u : 4u);
    chart.build(*topology, partition, triangles);
    EXPECT_EQ(chart.loops.size(), gap > 0 ? 2u : 1u);
  }
}

// A grid of 12 x 12 quads with three holes of one quad each.
TEST(Slits, HolesAreJoinedOneOrAll) {
  const Mesh mesh(grid(12, 12));
  const Result<Topology> topology = build_topology(mesh.view(), {}, {});
  ASSERT_TRUE(topology.ok());
  for (const bool all : {false, true}) {
    Partition partition;
    partition.seams.assign(topology->triangle_count(), 0);
    partition.local.resize(topology->triangle_count());
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t t = 0; t < topology->triangle_count(); ++t) {
      const std::uint32_t quad = t / 2;
      const bool hole = quad == 26 || quad == 31 || quad == 101;
      partition.chart.push_back(hole);
      if (!hole) triangles.push_back(t);
    }
    LocalChart chart;
    chart.build(*topology, partition, triangles);
    ASSERT_EQ(chart.loops.size(), 4u);
    const std::vector<std::uint32_t> loops = chart.loops;
    EXPECT_TRUE(
        join_loops(*topology, chart, all ? loops : std::vector<std::uint32_t>(), partition));
    chart.build(*topology, partition, triangles);
    EXPECT_EQ(chart.loops.size(), all ? 1u : 3u);
    EXPECT_EQ(chart.component_count, 1u);
    EXPECT_EQ(chart.euler(), all ? 1 : -1);
    EXPECT_EQ(join_loops(*topology, chart, {}, partition), !all);
  }
}

}  // namespace
}  // namespace atlas::test
