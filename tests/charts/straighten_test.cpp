// Straightening of seams. Compares the minimum cut with all cuts, borders with straight lines, and
// the charts with those before.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libatlas/charts/seams/min_cut.h"
#include "tests/charts/ragged_charts.h"
#include "tests/charts/toothed_wheel.h"

namespace atlas::test {
namespace {

TEST(MinCut, CostsWhatTheBestOfAllCutsCosts) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t n = 2 + random() % 9;
    struct Arcs {
      MinCut::Arc a, b;
      int weight;
    };
    std::vector<Arcs> edges;
    std::vector<std::array<int, 2>> ties(n);
    std::vector<std::uint32_t> free_slots(n, 0);
    MinCut cut;
    cut.reset(n);
    for (std::uint32_t k = 0; k < 2 * n; ++k) {
      const std::uint32_t a = random() % n, b = random() % n;
      if (a == b || free_slots[a] == 3 || free_slots[b] == 3) continue;
      edges.push_back({{a, free_slots[a]++}, {b, free_slots[b]++}, int(random() % 20)});
      cut.set_edge(edges.back().a, edges.back().b, edges.back().weight);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t s = 0; s < 2; ++s) {
        ties[i][s] = random() % 3 ? 0 : int(random() % 30);
        cut.tie(i, s, ties[i][s]);
      }
    }
    const auto cost = [&](const auto& side) {
      int sum = 0;
      for (const Arcs& e : edges) sum += side(e.a.node) != side(e.b.node) ? e.weight : 0;
      for (std::uint32_t i = 0; i < n; ++i) sum += ties[i][1 - side(i)];
      return sum;
    };
    int best = 1 << 30;
    for (std::uint32_t mask = 0; mask < 1u << n; ++mask) {
      best = std::min(best, cost([&](std::uint32_t i) { return mask >> i & 1; }));
    }
    cut.run();
    EXPECT_EQ(cost([&](std::uint32_t i) { return cut.side(i); }), best) << round;
  }
}

// Two charts of a square with teeth along their border that are four quads high.
RaggedCharts sawtooth() {
  const int n = 40;
  RaggedCharts charts(grid(n, n));
  for (std::uint32_t t = 0; t < charts.partition.chart.size(); ++t) {
    const int x = int(t / 2) % n, y = int(t / 2) / n;
    const int tooth = std::abs(y % 8 - 4);  // from 0 to 4
    charts.partition.chart[t] = x < n / 2 - 2 + tooth ? 0 : 1;
  }
  return charts;
}

TEST(Straighten, SawtoothBecomesALine) {
  RaggedCharts charts = sawtooth();
  const double before = charts.border_length();
  charts.straighten(12);
  EXPECT_GT(before, 1.8);
  EXPECT_NEAR(charts.border_length(), 1, 1e-6);
}

// The band is narrower than the teeth are high, so the border comes to lie along the rim of the
// band. There the band of one side falls into parts that are only connected outside of it.
TEST(Straighten, NarrowBandsShortenWhatTheyCan) {
  for (const std::uint8_t rings : {2, 3, 4, 6}) {
    RaggedCharts charts = sawtooth();
    const auto were = charts.topologies();
    const double before = charts.border_length();
    charts.straighten(rings);
    EXPECT_LT(charts.border_length(), (rings < 4 ? 0.95 : 0.8) * before) << int(rings);
    EXPECT_EQ(charts.topologies(), were) << int(rings);
  }
}

// A border around some sectors would be shorter than the rim. The charts would not be flat any
// more.
TEST(Straighten, CapsAroundHubsStayWhole) {
  constexpr std::uint32_t kTeeth = 250;
  RaggedCharts charts(toothed_wheel(kTeeth, 0.1));
  std::vector<std::uint32_t>& chart = charts.partition.chart;
  for (std::uint32_t t = 0; t < chart.size(); ++t) {
    const std::uint32_t quad = t / 4;
    chart[t] = t % 4 < 2 ? 2 + quad / (2 * kTeeth) : t % 4 - 2;  // caps, then halves of the rim
  }
  const std::vector<std::uint32_t> were = chart;
  for (const std::uint8_t rings : {1, 12}) {
    charts.straighten(rings);
    EXPECT_EQ(chart, were) << int(rings);
  }
}

TEST(Straighten, BordersOfChartsWithoutRingsStay) {
  RaggedCharts charts(sphere(48, 24));
  charts.grow(6, 3);
  const std::vector<std::uint32_t> were = charts.partition.chart;
  const std::vector<std::uint8_t> rings{8, 8, 8, 0, 0, 0};
  std::vector<std::uint32_t> triangles;  // triangles of charts with rings
  for (std::uint32_t t = 0; t < were.size(); ++t) {
    if (rings[were[t]] > 0) triangles.push_back(t);
  }
  RaggedCharts all = charts;
  straighten_borders(charts.topology, {{180, {}}, rings, triangles}, charts.partition, {});
  straighten_borders(all.topology, {{180, {}}, rings}, all.partition, {});
  EXPECT_EQ(charts.partition.chart, all.partition.chart);
  std::size_t moved = 0;
  for (std::uint32_t t = 0; t < were.size(); ++t) {
    if (charts.partition.chart[t] == were[t]) continue;
    ++moved;
    EXPECT_GT(rings[were[t]], 0) << t;
    EXPECT_GT(rings[charts.partition.chart[t]], 0) << t;
  }
  EXPECT_GT(moved, 0u);
}

TEST(Straighten, GoesToTheCreaseNearby) {
  // A border lies one quad beside an edge of a box. Along that edge, the length counts a quarter.
  RaggedCharts charts(box(16));
  const auto height = [&](std::uint32_t t) {
    double z = 0;
    for (std::uint32_t c = 0; c < 3; ++c) {
      z += charts.topology.points[charts.topology.corner_vertex[3 * t + c]].z / 3.0;
    }
    return z / charts.topology.scale;
  };
  for (std::uint32_t t = 0; t < charts.partition.chart.size(); ++t) {
    charts.partition.chart[t] = height(t) > 15.0 / 16 ? 1 : 0;
  }
  charts.straighten(12);
  for (std::uint32_t t = 0; t < charts.partition.chart.size(); ++t) {
    EXPECT_EQ(charts.partition.chart[t], charts.topology.normals[t].z > 0.5 ? 1u : 0u);
  }
}

// Charts neither fall apart nor close to a ring, borders do not get longer, and every frame lies in
// its triangle's plane.
TEST(Straighten, KeepsWhatChartsAre) {
  std::vector<Shape> shapes = {grid(30, 30),           sphere(40, 20),
                               torus(48, 16),          cylinder(60, 12),
                               plate_with_holes(3, 4), noisy(icosphere(4), 0.01, 5)};
  int shorter = 0;
  for (const Shape& shape : shapes) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      RaggedCharts charts(shape);
      charts.grow(3 + std::uint32_t(seed), seed);
      const auto were = charts.topologies();
      const double before = charts.border_length();
      charts.straighten(std::uint8_t(2 * seed), 180);
      EXPECT_EQ(charts.topologies(), were) << shape.name << ' ' << seed;
      EXPECT_LE(charts.border_length(), before) << shape.name << ' ' << seed;
      shorter += charts.border_length() < before;
      for (std::uint32_t t = 0; t < charts.topology.triangle_count(); ++t) {
        const Frames::Frame frame = charts.frames.at(charts.topology, t);
        for (const Vec3f& axis : frame) {
          ASSERT_NEAR(glm::dot(to_dvec(axis), to_dvec(charts.topology.normals[t])), 0, 1e-5);
        }
      }
    }
  }
  EXPECT_GT(shorter, 24);  // of 48 cases
}

// Triangles at seams of a chart with itself stay where they are.
TEST(Straighten, SeamsHaveTwoSidesInOneChart) {
  for (const Shape& shape : {grid(30, 30), sphere(40, 20), torus(48, 16)}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      RaggedCharts charts(shape);
      charts.grow(5, seed);
      charts.cut_at_random(30, seed);
      const std::vector<std::uint8_t> seams = charts.partition.seams;
      const std::vector<std::uint32_t> before = charts.partition.chart;
      charts.straighten(8, 180);
      EXPECT_EQ(charts.partition.seams, seams) << shape.name;
      EXPECT_EQ(charts.seam_faults(), 0u) << shape.name;
      EXPECT_NE(charts.partition.chart, before) << shape.name;
    }
  }
}

// Applied in order, the listed changes lead from the charts before to those after. The result does
// not depend on how many borders are processed at once.
TEST(Straighten, BordersAtOnceComeOutAsOneByOne) {
  for (const std::uint32_t count : {5u, 40u}) {
    RaggedCharts start(sphere(160, 80));
    start.grow(count, 3);
    const std::vector<std::uint8_t> rings(count, 6);
    std::vector<std::uint32_t> charts;
    for (const int threads : {1, 2, 5}) {
      RaggedCharts made = start;
      Context context;
      context.threads = threads;
      const std::vector<std::uint32_t> moved =
          straighten_borders(made.topology, {{40, {}}, rings}, made.partition, context);
      std::vector<std::uint32_t> replayed = start.partition.chart;
      for (const std::uint32_t h : moved) {
        replayed[h / 3] = replayed[made.topology.opposite[h] / 3];
      }
      EXPECT_EQ(replayed, made.partition.chart);
      EXPECT_GT(moved.size(), 100u);
      if (threads == 1) charts = made.partition.chart;
      EXPECT_EQ(made.partition.chart, charts) << threads << " threads, " << count << " charts";
    }
  }
}

TEST(Straighten, AConeHolds) {
  RaggedCharts charts(sphere(48, 24));
  charts.grow(6, 3);
  std::vector<Vec3f> axes(6, Vec3f{0, 0, 1});
  const auto outside = [&](std::uint32_t t) { return charts.topology.normals[t].z < 0.2f; };
  const std::vector<std::uint32_t> were = charts.partition.chart;
  const std::vector<std::uint8_t> rings(6, 8);
  straighten_borders(charts.topology, {{180, {axes, 0.2}}, rings}, charts.partition, {});
  std::size_t moved = 0;
  for (std::uint32_t t = 0; t < were.size(); ++t) {
    if (charts.partition.chart[t] == were[t]) continue;
    ++moved;
    EXPECT_FALSE(outside(t)) << t;
  }
  EXPECT_GT(moved, 10u);
}

}  // namespace
}  // namespace atlas::test
