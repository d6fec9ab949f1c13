// Flattens one chart that cannot be flattened as it is: which triangles it hands to its neighbours,
// from which uvs it continues, where it is cut, and when no cut is tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "libatlas/charts/flattening/chart_job.h"
#include "libatlas/charts/flattening/newcomers.h"
#include "libatlas/charts/flattening/split.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// kTurn is the number of columns in a whole turn.
constexpr int kColumns = 150, kRows = 6, kTurn = 110;

// Returns a ramp around the z axis with inner radius `inner` and width 1. Its z is its rise plus
// height(column, row). A ramp of more than one turn overlaps itself when it is laid flat.
template <class Height>
Shape ramp(int columns, double inner, const Height& height) {
  Shape shape;
  shape.name = "ramp";
  for (int a = 0; a <= columns; ++a) {
    for (int b = 0; b <= kRows; ++b) {
      const double turn = 2 * M_PI * a / kTurn, r = inner + double(b) / kRows;
      const double z = 0.2 * a / kTurn + height(a, b);
      shape.positions.push_back({float(r * std::cos(turn)), float(r * std::sin(turn)), float(z)});
    }
  }
  const auto at = [](int a, int b) { return std::uint32_t(a * (kRows + 1) + b); };
  for (int a = 0; a < columns; ++a) {
    for (int b = 0; b < kRows; ++b) {
      shape.indices.insert(shape.indices.end(), {at(a, b), at(a, b + 1), at(a + 1, b + 1)});
      shape.indices.insert(shape.indices.end(), {at(a, b), at(a + 1, b + 1), at(a + 1, b)});
    }
  }
  return shape;
}

// Adds waves, so that no part of the ramp unrolls exactly.
Shape wavy_ramp(double wave, int columns = kColumns) {
  return ramp(columns, 3, [=](int a, int b) {
    return wave * std::sin(M_PI * b / kRows) * std::sin(18 * M_PI * a / kTurn);
  });
}

// Adds spikes that are `spike` rows high at the middle of some columns.
Shape spiked_ramp(double spike, int columns) {
  return ramp(columns, 2,
              [=](int a, int b) { return b == kRows / 2 && a % 60 == 30 ? spike / kRows : 0; });
}

// Assigns `rounds` charts of almost one turn of the ramp each, from chart 0 on. Each has a tooth of
// `length` columns and `width` rows at its end, in other rows than the next chart's tooth. The
// tooth reaches beyond the chart's own beginning and into the next chart. There is one more chart
// before these and one after them.
std::vector<std::uint32_t> toothed(int length, int width, int rounds = 1, int columns = kColumns) {
  constexpr int kFirst = 10, kLong = kTurn - 1;
  std::vector<std::uint32_t> charts;
  for (int a = 0; a < columns; ++a) {
    for (int b = 0; b < kRows; ++b) {
      int chart = a < kFirst ? rounds + 1 : std::min(rounds, (a - kFirst) / kLong);
      for (int r = 0; r < rounds; ++r) {
        const int begin = kFirst + (r + 1) * kLong, row = 2 + 2 * r;
        const bool tooth = a >= begin && a < begin + length && b >= row && b < row + width;
        if (tooth) chart = r;
      }
      charts.insert(charts.end(), 2, std::uint32_t(chart));
    }
  }
  return charts;
}

// A mesh with charts, and what is needed to flatten one of them.
struct Bench {
  Topology topology;
  Partition partition;
  ChartOptions options;
  Frames frames;
  ChartScratch scratch;

  Bench(const Shape& shape, std::vector<std::uint32_t> charts) {
    const Mesh mesh(shape);
    Result<Topology> built = build_topology(mesh.view(), {}, {});
    EXPECT_TRUE(built.ok());
    topology = std::move(*built);
    partition.chart = std::move(charts);
    partition.seams.assign(topology.triangle_count(), 0);
    partition.local.resize(topology.triangle_count());
  }
  FlattenInput input() { return {topology, {}, options, frames}; }
  std::vector<std::uint32_t> triangles(std::uint32_t chart) const {
    std::vector<std::uint32_t> list;
    for (std::uint32_t t = 0; t < partition.chart.size(); ++t) {
      if (partition.chart[t] == chart) list.push_back(t);
    }
    return list;
  }
  ChartOutcome flatten(std::uint32_t chart, ChartTask task = {}) {
    const std::vector<std::uint32_t> own = triangles(chart);
    task.triangles = own;
    return flatten_chart(input(), partition, task, scratch);
  }
  bool any_seam() const {
    return std::any_of(partition.seams.begin(), partition.seams.end(),
                       [](std::uint8_t bits) { return bits != 0; });
  }
};

using Triangle2 = std::array<Vec2d, 3>;

double uv_length(const Vec2d& a, const Vec2d& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

double size_of(const Triangle2& t) {
  return uv_length(t[0], t[1]) + uv_length(t[1], t[2]) + uv_length(t[2], t[0]);
}

Triangle2 scaled(const Triangle2& t, double factor) {
  const auto at = [&](int k) { return Vec2d{factor * t[k].x, factor * t[k].y}; };
  return {at(0), at(1), at(2)};
}

// Returns the largest relative change of a triangle's edge lengths. If it was only rotated and
// moved, that is rounding.
double change(const Triangle2& a, const Triangle2& b) {
  double most = 0;
  for (int k = 0; k < 3; ++k) {
    const double was = uv_length(a[k], a[(k + 1) % 3]), is = uv_length(b[k], b[(k + 1) % 3]);
    most = std::max(most, std::abs(is - was) / was);
  }
  return most;
}

Triangle2 corners_of(const FlatChart& chart, std::size_t i) {
  const auto& v = chart.corners[i];
  return {chart.uvs[v[0]], chart.uvs[v[1]], chart.uvs[v[2]]};
}

TEST(ChartJob, NamesTheTrianglesThatShouldGo) {
  Bench bench(wavy_ramp(0.05), toothed(5, 2));
  const ChartOutcome outcome = bench.flatten(0);
  const std::vector<std::uint32_t> own = bench.triangles(0);
  EXPECT_TRUE(outcome.failed);
  EXPECT_GT(outcome.crossings, 0u);
  ASSERT_FALSE(outcome.remove.empty());
  EXPECT_LT(outcome.remove.size(), own.size() / 20);
  EXPECT_EQ(outcome.uvs.size(), 3 * own.size());
  // All are near the tooth or where it overlaps the chart, and none is listed twice.
  std::vector<std::uint32_t> remove = outcome.remove;
  std::sort(remove.begin(), remove.end());
  EXPECT_EQ(std::adjacent_find(remove.begin(), remove.end()), remove.end());
  for (const std::uint32_t t : remove) {
    const int column = int(t) / (2 * kRows);
    EXPECT_TRUE(column < 20 || column > kTurn) << column;
  }
  // With more rings around the crossings there are more triangles, and these include the first
  // ones.
  Bench again(wavy_ramp(0.05), toothed(5, 2));
  std::vector<std::uint32_t> more = again.flatten(0, {.rings = 2}).remove;
  std::sort(more.begin(), more.end());
  EXPECT_GT(more.size(), remove.size());
  EXPECT_TRUE(std::includes(more.begin(), more.end(), remove.begin(), remove.end()));
}

// The tooth goes to the following chart. Nothing is divided and nothing is lost.
TEST(ChartJob, WhatCrossesGoesToTheNeighbours) {
  for (const auto& [wave, length, width] : {std::tuple{0.05, 5, 1}, std::tuple{0.02, 5, 2},
                                            std::tuple{0.0, 5, 2}, std::tuple{0.0, 2, 3}}) {
    Bench bench(wavy_ramp(wave), toothed(length, width));
    const std::size_t before = bench.triangles(0).size();
    const FlattenResult result = flatten_charts(bench.input(), bench.partition, {});
    EXPECT_EQ(result.split_charts(), 0u) << length << ' ' << width;
    ASSERT_EQ(result.charts.size(), 3u) << length << ' ' << width;
    std::size_t all = 0, largest = 0;
    for (const FlatChart& chart : result.charts) {
      all += chart.triangles.size();
      largest = std::max(largest, chart.triangles.size());
      EXPECT_EQ(chart.distortion.flips, 0u);
      EXPECT_LE(chart.distortion.stretch_999, 1.25);
    }
    EXPECT_EQ(all, bench.topology.triangle_count());
    EXPECT_LT(largest, before);
    EXPECT_GT(largest, before - before / 20);
  }
}

// After losing triangles, a chart continues from the uvs that it had.
TEST(ChartJob, GoesOnFromItsUvsWhenTrianglesAreGone) {
  Bench bench(wavy_ramp(0.05), toothed(5, 2));
  const std::vector<std::uint32_t> before = bench.triangles(0);
  const ChartOutcome first = bench.flatten(0);
  ASSERT_EQ(first.uvs.size(), 3 * before.size());
  std::vector<Vec2d> kept;
  std::vector<Triangle2> was;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::uint32_t t = before[i];
    if (int(t) / (2 * kRows) >= 10 + kTurn - 1) {  // it belongs to the tooth
      bench.partition.chart[t] = 2;
      continue;
    }
    kept.insert(kept.end(), &first.uvs[3 * i], &first.uvs[3 * i] + 3);
    was.push_back({first.uvs[3 * i], first.uvs[3 * i + 1], first.uvs[3 * i + 2]});
  }
  const ChartOutcome resumed = bench.flatten(0, {.resumed = kept});
  ASSERT_TRUE(resumed.parts.empty());
  ASSERT_EQ(resumed.flat.corners.size(), was.size());
  // The chart keeps the area of its surface, which has lost that of the tooth.
  const double scale = size_of(corners_of(resumed.flat, 0)) / size_of(was[0]);
  for (std::size_t i = 0; i < was.size(); ++i) {
    EXPECT_LT(change(scaled(was[i], scale), corners_of(resumed.flat, i)), 1e-9) << i;
  }
}

// Triangles that come back are placed beside the rest, which stays as it is.
TEST(ChartJob, LaysWhatItGotBesideWhatItHad) {
  constexpr int kShort = 90;
  Bench bench(wavy_ramp(0.05, kShort), std::vector<std::uint32_t>(2 * kRows * kShort, 0));
  const std::vector<std::uint32_t> all = bench.triangles(0);
  const ChartOutcome first = bench.flatten(0);
  ASSERT_TRUE(first.parts.empty());
  std::vector<Vec2d> kept;
  std::vector<std::uint8_t> newcomer;
  for (std::size_t i = 0; i < all.size(); ++i) {
    newcomer.push_back(i / (2 * kRows) >= kShort - 4 && i % (2 * kRows) < kRows);
    for (const std::uint32_t v : first.flat.corners[i]) {
      kept.push_back(newcomer[i] ? unplaced() : first.flat.uvs[v]);
    }
  }
  const ChartOutcome grown = bench.flatten(0, {.resumed = kept, .little = true});
  ASSERT_TRUE(grown.parts.empty());
  EXPECT_EQ(grown.flat.distortion.flips, 0u);
  EXPECT_LE(grown.flat.distortion.stretch_999, 1.25);
  const double scale = size_of(corners_of(grown.flat, 0)) / size_of(corners_of(first.flat, 0));
  std::size_t moved = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Triangle2 was = scaled(corners_of(first.flat, i), scale);
    if (newcomer[i]) {
      moved += change(was, corners_of(grown.flat, i)) > 1e-9;
    } else {
      EXPECT_LT(change(was, corners_of(grown.flat, i)), 1e-9) << i;
    }
  }
  EXPECT_GT(moved, 0u);
}

// Does the same for a job that is interrupted between two rounds. What is left of the chart is in
// its list of triangles, each with its own uvs.
TEST(ChartJob, RoundsGoOnFromTheLast) {
  Bench once(wavy_ramp(0.05), toothed(4, 1)), rounds(wavy_ramp(0.05), toothed(4, 1));
  const std::vector<std::uint32_t> before = once.triangles(0);
  const ChartOutcome first = once.flatten(0);
  ASSERT_EQ(first.uvs.size(), 3 * before.size());
  const FlattenResult result = flatten_charts(rounds.input(), rounds.partition, {});
  const auto kept = std::max_element(result.charts.begin(), result.charts.end(),
                                     [](const FlatChart& a, const FlatChart& b) {
                                       return a.triangles.size() < b.triangles.size();
                                     });
  double scale = 0;
  std::size_t same = 0;
  for (std::size_t i = 0; i < kept->triangles.size(); ++i) {
    const auto at = std::lower_bound(before.begin(), before.end(), kept->triangles[i]);
    if (at == before.end() || *at != kept->triangles[i]) continue;
    const std::size_t k = 3 * std::size_t(at - before.begin());
    const Triangle2 was{first.uvs[k], first.uvs[k + 1], first.uvs[k + 2]};
    if (scale == 0) scale = size_of(corners_of(*kept, i)) / size_of(was);
    same += change(scaled(was, scale), corners_of(*kept, i)) < 1e-9;
  }
  EXPECT_EQ(same, kept->triangles.size());
}

// Two charts that cross themselves hand over triangles. The first gives some to the second, which
// then needs other uvs than before.
TEST(ChartJob, ChartsThatGetTrianglesComeOutWhole) {
  const int columns = 10 + 2 * (kTurn - 1) + 40;
  for (const double wave : {0.0, 0.05}) {
    for (const auto& [length, width] : {std::pair{3, 2}, std::pair{5, 1}, std::pair{8, 1}}) {
      Bench bench(wavy_ramp(wave, columns), toothed(length, width, 2, columns));
      const FlattenResult result = flatten_charts(bench.input(), bench.partition, {});
      std::size_t all = 0;
      for (const FlatChart& chart : result.charts) {
        all += chart.triangles.size();
        EXPECT_EQ(chart.distortion.flips, 0u);
        EXPECT_LE(chart.distortion.stretch_999, 1.25);
      }
      EXPECT_EQ(all, bench.topology.triangle_count());
      EXPECT_LE(result.split_charts(), 2u) << length << ' ' << width;
    }
  }
}

// Spikes stretch beyond the bound until they are cut open. Where the border crosses itself, too, no
// cut is made, because none would help.
TEST(ChartJob, NothingIsCutThatCrossesItselfAnyway) {
  for (const double spike : {1.0, 1.3}) {
    Bench open(spiked_ramp(spike, 99), std::vector<std::uint32_t>(99 * 2 * kRows, 0));
    EXPECT_TRUE(open.flatten(0).parts.empty());
    EXPECT_TRUE(open.any_seam());
    Bench crossing(spiked_ramp(spike, 154), std::vector<std::uint32_t>(154 * 2 * kRows, 0));
    const ChartOutcome outcome = crossing.flatten(0);
    EXPECT_TRUE(outcome.failed);
    EXPECT_EQ(outcome.parts.size(), 154u * 2 * kRows);
    EXPECT_FALSE(crossing.any_seam());
  }
}

// A chart of several pieces is divided into them, which is not a failure.
TEST(ChartJob, PiecesComeApart) {
  const Shape shape = together(together(grid(4, 4), moved(grid(3, 3), 1, {5, 0, 0})),
                               moved(grid(2, 2), 1, {0, 5, 0}));
  Bench bench(shape, std::vector<std::uint32_t>(shape.triangle_count(), 0));
  const ChartOutcome outcome = bench.flatten(0);
  EXPECT_FALSE(outcome.failed);
  ASSERT_EQ(outcome.parts.size(), shape.triangle_count());
  for (std::size_t t = 0; t < outcome.parts.size(); ++t) {
    EXPECT_EQ(outcome.parts[t], t < 32 ? 0 : t < 50 ? 1 : 2) << t;
  }
  const FlattenResult result = flatten_charts(bench.input(), bench.partition, {});
  EXPECT_EQ(result.split_charts(), 0u);
  ASSERT_EQ(result.charts.size(), 3u);
  EXPECT_EQ(result.charts[1].triangles.size(), 18u);
}

// A large part is flat already, and two columns do not fit it. Only their surroundings change,
// whereas the union of two equal parts is squeezed as a whole.
TEST(ChartJob, ALittlePartLeavesALargeOneAsItIs) {
  constexpr int columns = 80, fitting = columns - 2;
  for (const double stretch : {1.4, 1.5, 1.6}) {
    for (const bool little : {true, false}) {
      Bench bench(wavy_ramp(0.1, columns), std::vector<std::uint32_t>(columns * 2 * kRows, 0));
      const ChartOutcome whole = bench.flatten(0);
      ASSERT_TRUE(whole.parts.empty());
      std::vector<Vec2d> joined;
      std::vector<Triangle2> was;
      const Vec2d joint = corners_of(whole.flat, fitting * 2 * kRows)[0];
      for (std::size_t i = 0; i < whole.flat.corners.size(); ++i) {
        was.push_back(corners_of(whole.flat, i));
        const double f = int(i) / (2 * kRows) < fitting ? 1 : stretch;
        for (const Vec2d& p : was.back()) {
          joined.push_back({joint.x + f * (p.x - joint.x), joint.y + (p.y - joint.y) / f});
        }
      }
      const ChartOutcome both =
          bench.flatten(0, {.cuts = 0, .joined = joined, .little = little, .whole = true});
      ASSERT_TRUE(both.parts.empty());
      EXPECT_LE(both.flat.distortion.stretch_999, 1.25);
      EXPECT_EQ(both.flat.distortion.flips, 0u);
      // Both keep the area of the surface, so they are compared at the size of the first triangle.
      const double scale = size_of(corners_of(both.flat, 0)) / size_of(was[0]);
      const std::size_t far_off = 50 * 2 * kRows;
      double most = 0;
      for (std::size_t i = 0; i < far_off; ++i) {
        most = std::max(most, change(scaled(was[i], scale), corners_of(both.flat, i)));
      }
      if (little) {
        EXPECT_LT(most, 1e-6) << stretch;
      } else {
        EXPECT_GT(most, 1e-5) << stretch;
      }
    }
  }
}

// Of the two triangles of a crossing, the one with fewer neighbours is removed, with the given
// number of rings around it.
TEST(ChartJob, TheLooserSideOfACrossingGoes) {
  Bench bench(grid(6, 6), std::vector<std::uint32_t>(72, 0));
  LocalChart& chart = bench.scratch.chart;
  const std::vector<std::uint32_t> all = bench.triangles(0);
  chart.build(bench.topology, bench.partition, all);
  const auto degree = [&](std::uint32_t t) {
    int count = 0;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) count += chart.opposite[h] != kNoIndex;
    return count;
  };
  for (std::uint32_t a = 0; a < 72; a += 5) {
    for (std::uint32_t b = 0; b < 72; b += 7) {
      const std::vector<BorderCrossing> crossings{{{}, {}, a, b}};
      const auto one = around_crossings(chart, crossings, 0);
      ASSERT_EQ(one.size(), 1u);
      EXPECT_EQ(one[0], degree(b) < degree(a) ? b : a);
      const auto ring = around_crossings(chart, crossings, 1);
      EXPECT_EQ(ring.size(), 1u + std::size_t(degree(one[0])));
    }
  }
}

}  // namespace
}  // namespace atlas::test
