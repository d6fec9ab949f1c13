// Triangles between any of a few points: many of them share an edge, some repeat others or have no
// area, and often no orientation suits all.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/random.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// Returns up to `most` triangles between 5 to 14 points, in one or two materials.
Mesh any_triangles(std::uint64_t seed, std::uint32_t most = 40) {
  std::mt19937_64 random(seed);
  Mesh mesh;
  const auto points = std::uint32_t(5 + random() % 10);
  for (std::uint32_t v = 0; v < points; ++v) {
    mesh.positions.push_back(
        {float(uniform(random)), float(uniform(random)), float(uniform(random))});
  }
  const auto triangles = std::uint32_t(2 + random() % (most - 1));
  for (std::uint32_t t = 0; t < triangles; ++t) {
    for (int c = 0; c < 3; ++c) mesh.indices.push_back(std::uint32_t(random() % points));
    mesh.materials.push_back(seed % 3 == 0 ? std::uint32_t(random() % 2) : 0);
  }
  return mesh;
}

constexpr std::uint64_t kSeeds = 200;

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge(const Topology& topology, std::uint32_t h) {
  return std::minmax(topology.corner_vertex[h], topology.corner_vertex[next_half_edge(h)]);
}

// Returns how many triangles with area have each edge.
std::map<Edge, int> triangles_of_edges(const Topology& topology) {
  std::map<Edge, int> count;
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h)
    if (!topology.degenerate(h / 3)) ++count[edge(topology, h)];
  return count;
}

TEST(AnyTriangles, SeamsAreMeasuredInAnyUnit) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Mesh mesh = any_triangles(seed);
    const double unit = seed % 2 ? 1000 : 0.03;
    for (Vec3f& p : mesh.positions) p = {float(unit * p.x), float(unit * p.y), float(unit * p.z)};
    const ChartSet set = checked_charts(mesh);
    const ChartFindings found = check_charts(mesh.view(), set);
    EXPECT_NEAR(set.seam_length, found.seam, 1e-5 * (unit + found.seam));
  }
}

TEST(AnyTriangles, AChartHasOneMaterial) {
  for (std::uint64_t seed = 0; seed < kSeeds; seed += 3) {
    const Mesh mesh = any_triangles(seed);
    const ChartSet set = checked_charts(mesh);
    for (std::uint32_t t = 0; t < mesh.materials.size(); ++t)
      EXPECT_EQ(set.charts[set.triangle_chart[t]].material, mesh.materials[t]) << seed;
  }
}

TEST(AnyTriangles, LinksAreMutualAndAgreeInDirection) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const Topology topology = topology_of(any_triangles(seed));
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex) continue;
      ASSERT_EQ(topology.opposite[o], h);
      ASSERT_EQ(topology.corner_vertex[h], topology.corner_vertex[next_half_edge(o)]);
      ASSERT_EQ(topology.corner_vertex[next_half_edge(h)], topology.corner_vertex[o]);
      ASSERT_EQ(topology.component[h / 3], topology.component[o / 3]);
    }
  }
}

TEST(AnyTriangles, LinksAtEdgesOfManyTrianglesAreListed) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Topology topology = topology_of(any_triangles(seed));
    const std::map<Edge, int> count = triangles_of_edges(topology);
    std::multiset<Edge> linked, listed;
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o != kNoIndex && h < o && count.at(edge(topology, h)) > 2)
        linked.insert(edge(topology, h));
    }
    for (const std::uint32_t h : topology.fan_links)
      if (topology.opposite[h] != kNoIndex) listed.insert(edge(topology, h));
    EXPECT_EQ(listed, linked) << seed;
  }
}

// Around each vertex, triangles that are linked there form one fan.
TEST(AnyTriangles, VerticesOfSeveralFansAreCounted) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Topology topology = topology_of(any_triangles(seed, 12));
    std::vector<std::uint32_t> fan(topology.corner_vertex.size());
    std::iota(fan.begin(), fan.end(), 0u);
    const auto root = [&](std::uint32_t corner) {
      while (fan[corner] != corner) corner = fan[corner];
      return corner;
    };
    for (std::uint32_t h = 0; h < fan.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex) continue;
      fan[root(h)] = root(next_half_edge(o));
      fan[root(next_half_edge(h))] = root(o);
    }
    std::map<std::uint32_t, std::set<std::uint32_t>> fans;  // by vertex
    for (std::uint32_t h = 0; h < fan.size(); ++h)
      if (!topology.degenerate(h / 3)) fans[topology.corner_vertex[h]].insert(root(h));
    const auto several =
        std::count_if(fans.begin(), fans.end(), [](const auto& f) { return f.second.size() > 1; });
    EXPECT_EQ(topology.defects.nonmanifold_vertices, std::uint64_t(several)) << seed;
  }
}

// A triangle and its copy: two sides of a fin if one is turned against the other, else two sheets.
TEST(AnyTriangles, OnlyCopiesThatAreTurnedAreOnePiece) {
  for (const bool turned : {false, true}) {
    Mesh mesh;
    mesh.positions = {{0.25f, 0.5f, 0}, {0, 0, 0}, {1, 0, 0}};
    mesh.indices = {0, 1, 2, 0, turned ? 2u : 1u, turned ? 1u : 2u};
    const Topology topology = topology_of(mesh);
    EXPECT_EQ(topology.component_count, turned ? 1u : 2u);
    EXPECT_EQ(topology.defects.misoriented_edges, 0u);
    EXPECT_EQ(topology.opposite[1], turned ? 4u : kNoIndex) << "the longest edge";
    EXPECT_EQ(std::count(topology.opposite.begin(), topology.opposite.end(), kNoIndex),
              turned ? 4 : 6);
  }
}

TEST(AnyTriangles, DefectsAreCounted) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Mesh mesh = any_triangles(seed);
    const Topology topology = topology_of(mesh);
    std::set<std::array<std::uint32_t, 3>> distinct;
    std::uint64_t repeated = 0, edges = 0;
    for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
      if (topology.degenerate(t)) continue;
      std::array<std::uint32_t, 3> v{mesh.indices[3 * t], mesh.indices[3 * t + 1],
                                     mesh.indices[3 * t + 2]};
      std::sort(v.begin(), v.end());
      repeated += !distinct.insert(v).second;
    }
    for (const auto& [ends, count] : triangles_of_edges(topology)) edges += count > 2;
    EXPECT_EQ(topology.defects.duplicate_triangles, repeated) << seed;
    EXPECT_EQ(topology.defects.nonmanifold_edges, edges) << seed;
  }
}

}  // namespace
}  // namespace atlas::test
