// Flattens one chart that cannot be flattened as it is: which triangles it hands to its neighbours,
// from which uvs it continues, where it is cut, and when no cut is tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libatlas/charts/flattening/chart_job.h"
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

}  // namespace
}  // namespace atlas::test
