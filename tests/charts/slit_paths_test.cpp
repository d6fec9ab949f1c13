// Straightens the seams that charts have with themselves (slits).
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <set>

#include "libatlas/charts/seams/slit_paths.h"
#include "tests/charts/ragged_charts.h"

namespace atlas::test {
namespace {

struct Slitted : RaggedCharts {
  using RaggedCharts::RaggedCharts;

  std::uint32_t from(std::uint32_t h) const { return topology.corner_vertex[h]; }
  std::uint32_t to(std::uint32_t h) const { return from(next_half_edge(h)); }

  // Cuts within chart k along a crooked path from a vertex for which `start` holds to one for which
  // `end` does.
  void cut(std::uint32_t k, const std::function<bool(std::uint32_t)>& start,
           const std::function<bool(std::uint32_t)>& end, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<double> weight(topology.opposite.size(), 1e9);
    for (std::uint32_t h = 0; h < weight.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || o < h) continue;
      if (partition.chart[h / 3] != k || partition.chart[o / 3] != k) continue;
      weight[h] = weight[o] = edge_length(topology, h) * (1 + double(random() % 1000) / 200);
    }
    std::vector<double> distance(topology.points.size(), 1e300);
    std::vector<std::uint32_t> through(topology.points.size(), kNoIndex);
    for (std::uint32_t v = 0; v < distance.size(); ++v) distance[v] = start(v) ? 0 : 1e300;
    for (bool any = true; any;) {  // Bellman-Ford
      any = false;
      for (std::uint32_t h = 0; h < weight.size(); ++h) {
        if (weight[h] > 1e8 || start(to(h)) || end(from(h))) continue;
        if (distance[from(h)] + weight[h] >= distance[to(h)]) continue;
        distance[to(h)] = distance[from(h)] + weight[h];
        through[to(h)] = h;
        any = true;
      }
    }
    std::uint32_t last = kNoIndex;
    for (std::uint32_t v = 0; v < distance.size(); ++v) {
      if (end(v) && (last == kNoIndex || distance[v] < distance[last])) last = v;
    }
    for (std::uint32_t v = last; through[v] != kNoIndex; v = from(through[v])) {
      partition.cut(through[v]);
      partition.cut(topology.opposite[through[v]]);
    }
  }

  double slit_length() const {
    double length = 0;
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      EXPECT_TRUE(o == kNoIndex || partition.seam(h) == partition.seam(o)) << h;
      if (partition.seam(h)) length += edge_length(topology, h) / 2;
    }
    return length / topology.scale;
  }

  std::set<std::uint32_t> slit_ends() const {
    std::vector<int> count(topology.points.size(), 0);
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      if (partition.seam(h)) ++count[from(h)];
    }
    std::set<std::uint32_t> ends;
    for (std::uint32_t v = 0; v < count.size(); ++v) {
      if (count[v] == 1) ends.insert(v);
    }
    return ends;
  }

  double height(std::uint32_t v) const { return topology.points[v].z / topology.scale; }

  // Carries the first triangle's frame to all others of its chart, but not across slits.
  void carry_frames() {
    std::vector<std::uint8_t> done(topology.triangle_count(), 0);
    for (std::uint32_t seed = 0; seed < done.size(); ++seed) {
      if (done[seed]) continue;
      done[seed] = 1;
      std::vector<std::uint32_t> queue{seed};
      for (std::size_t i = 0; i < queue.size(); ++i) {
        each_link(queue[i], [&](std::uint32_t o) {
          if (done[o / 3]) return;
          done[o / 3] = 1;
          frames.put(o / 3, carry_frame(topology, frames.at(topology, queue[i]), queue[i], o / 3));
          queue.push_back(o / 3);
        });
      }
    }
  }

  // Returns the worst agreement of frames across edges that are no seams, as a cosine.
  double least_agreement() const {
    double least = 1;
    for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
      each_link(t, [&](std::uint32_t o) {
        const Frames::Frame there = frames.at(topology, o / 3),
                            carried = carry_frame(topology, frames.at(topology, t), t, o / 3);
        least = std::min(least, glm::dot(to_dvec(there[0]), to_dvec(carried[0])));
      });
    }
    return least;
  }

  template <class Visit>
  void each_link(std::uint32_t t, const Visit& visit) const {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || partition.seam(h)) continue;
      if (partition.chart[o / 3] == partition.chart[t]) visit(o);
    }
  }
};

const std::vector<std::uint8_t> kBands(8, 4);

Slitted tube(int around, int along, double height) {
  Slitted charts(cylinder(around, along, 1, height));
  std::fill(charts.partition.chart.begin(), charts.partition.chart.end(), 0u);
  return charts;
}

using Disc = std::pair<std::uint32_t, int>;  // number of pieces, Euler characteristic

TEST(SlitPaths, ATubesSlitBecomesStraighter) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Slitted charts = tube(48, 60, 8);
    charts.cut(
        0, [&](std::uint32_t v) { return charts.height(v) < 1e-6; },
        [&](std::uint32_t v) { return charts.height(v) > 8 - 1e-6; }, seed);
    charts.carry_frames();
    const double before = charts.slit_length();
    ASSERT_EQ(charts.topologies()[0], Disc(1, 1));
    ASSERT_GT(charts.least_agreement(), 0.999);
    Slits slits(charts.topology, {{40, {}}, kBands}, charts.partition, charts.frames);
    slits.straighten();
    EXPECT_GT(before, 8.5);
    EXPECT_LT(charts.slit_length(), 0.975 * before);
    EXPECT_EQ(charts.topologies()[0], Disc(1, 1)) << seed;
    EXPECT_GT(charts.least_agreement(), 0.999) << seed;
  }
}

TEST(SlitPaths, TipsStayWhereTheyAre) {
  double sum_before = 0, sum_after = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Slitted charts(noisy(icosphere(4), 0.003, seed));
    std::fill(charts.partition.chart.begin(), charts.partition.chart.end(), 0u);
    const std::uint32_t a = std::uint32_t(37 * seed), b = std::uint32_t(1500 + 11 * seed);
    charts.cut(
        0, [&](std::uint32_t v) { return v == a; }, [&](std::uint32_t v) { return v == b; }, seed);
    const double before = charts.slit_length();
    ASSERT_EQ(charts.slit_ends(), (std::set{a, b}));
    Slits slits(charts.topology, {{40, {}}, kBands}, charts.partition, charts.frames);
    slits.straighten();
    EXPECT_LE(charts.slit_length(), before);
    sum_before += before;
    sum_after += charts.slit_length();
    EXPECT_EQ(charts.slit_ends(), (std::set{a, b}));
    EXPECT_EQ(charts.topologies()[0], Disc(1, 1)) << seed;
  }
  EXPECT_LT(sum_after, 0.95 * sum_before);
}

// Slits that branch or end in the interior, starting at a border: charts that are discs stay discs.
TEST(SlitPaths, DiscsStayDiscs) {
  int shorter = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Slitted charts = tube(40, 20, 3);
    const auto low = [&](std::uint32_t v) { return charts.height(v) < 1e-6; };
    charts.cut(
        0, low, [&](std::uint32_t v) { return charts.height(v) > 3 - 1e-6; }, seed);
    for (int branch = 0; branch < 3; ++branch) {
      std::set<std::uint32_t> taken;
      for (std::uint32_t h = 0; h < charts.topology.opposite.size(); ++h) {
        if (charts.partition.seam(h)) taken.insert(charts.from(h));
      }
      const auto tip = std::uint32_t(seed * 31 + std::uint64_t(branch) * 211) % 700 + 60;
      if (taken.count(tip)) continue;
      charts.cut(
          0, [&](std::uint32_t v) { return branch < 2 ? taken.count(v) > 0 : low(v); },
          [&](std::uint32_t v) { return v == tip; }, seed + 100);
    }
    const auto were = charts.topologies();
    const double before = charts.slit_length();
    Slits slits(charts.topology, {{40, {}}, kBands}, charts.partition, charts.frames);
    slits.straighten();
    EXPECT_EQ(charts.topologies(), were) << seed;
    EXPECT_LE(charts.slit_length(), before) << seed;
    shorter += charts.slit_length() < 0.95 * before;
  }
  EXPECT_GT(shorter, 15);
}

// Two tubes end to end, with a ragged border between them where their slits end.
TEST(SlitPaths, BordersMoveAcrossClosedSlits) {
  int shorter = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Slitted charts = tube(48, 40, 6);
    std::mt19937_64 random(seed);
    std::vector<double> ridge(48);
    for (double& r : ridge) r = 3 + double(random() % 7) / 10;
    for (std::uint32_t t = 0; t < charts.topology.triangle_count(); ++t) {
      const Vec3f& p = charts.topology.points[charts.topology.corner_vertex[3 * t]];
      const auto column = std::size_t((std::atan2(p.y, p.x) + M_PI) / (2 * M_PI) * 47.999);
      charts.partition.chart[t] =
          charts.height(charts.topology.corner_vertex[3 * t]) > ridge[column];
    }
    const auto tubes = charts.topologies();
    if (tubes.at(0) != Disc(1, 0) || tubes.at(1) != Disc(1, 0)) continue;
    std::set<std::uint32_t> between;
    for (std::uint32_t h = 0; h < charts.topology.opposite.size(); ++h) {
      const std::uint32_t o = charts.topology.opposite[h];
      if (o == kNoIndex || charts.partition.chart[h / 3] == charts.partition.chart[o / 3]) continue;
      between.insert(charts.from(h));
    }
    const auto middle = [&](std::uint32_t v) { return between.count(v) > 0; };
    charts.cut(
        0, [&](std::uint32_t v) { return charts.height(v) < 1e-6; }, middle, seed);
    charts.cut(
        1, middle, [&](std::uint32_t v) { return charts.height(v) > 6 - 1e-6; }, seed);
    const auto were = charts.topologies();
    ASSERT_EQ(were.at(0), Disc(1, 1));
    ASSERT_EQ(were.at(1), Disc(1, 1));
    const double before = charts.border_length();
    Slits slits(charts.topology, {{40, {}}, kBands}, charts.partition, charts.frames);
    slits.close();
    EXPECT_EQ(charts.slit_length(), 0);
    charts.straighten(4);
    slits.reopen();
    slits.straighten();
    EXPECT_EQ(charts.topologies(), were) << seed;
    EXPECT_LT(charts.slit_length(), 7.5);  // the slits do not become long detours
    shorter += charts.border_length() < 0.8 * before;
  }
  EXPECT_GT(shorter, 10);
}

// While the slits are closed, the lower of two tubes loses rings to the upper one. What is left of
// its slit is cut again, and the upper one's is extended to the new border.
TEST(SlitPaths, EndAtTheBorderWhereverItIs) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Slitted charts = tube(24, 24, 6);
    const auto place_border = [&](double height) {
      for (std::uint32_t t = 0; t < charts.topology.triangle_count(); ++t) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) sum += charts.height(charts.topology.corner_vertex[3 * t + c]);
        charts.partition.chart[t] = sum > 3 * height;
      }
    };
    const auto at = [&](double height) {
      return
          [&charts, height](std::uint32_t v) { return std::abs(charts.height(v) - height) < 1e-3; };
    };
    place_border(3);
    charts.cut(0, at(0), at(3), seed);
    charts.cut(1, at(3), at(6), seed + 100);
    ASSERT_EQ(charts.topologies().at(0), Disc(1, 1));
    ASSERT_EQ(charts.topologies().at(1), Disc(1, 1));
    Slits slits(charts.topology, {{40, {}}, kBands}, charts.partition, charts.frames);
    slits.close();
    ASSERT_EQ(charts.slit_length(), 0);
    place_border(2.25);
    slits.reopen();
    EXPECT_EQ(charts.topologies().at(0), Disc(1, 1)) << seed;
    EXPECT_EQ(charts.topologies().at(1), Disc(1, 1)) << seed;
    EXPECT_EQ(charts.seam_faults(), 0u) << seed;
    EXPECT_EQ(charts.slit_ends().size(), 4u) << seed;
  }
}

}  // namespace
}  // namespace atlas::test
