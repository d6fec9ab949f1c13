// Frames, lattices and slit rings, which no chord divides with a gain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "libatlas/charts/filling/middle_cut.h"
#include "libatlas/charts/flattening/part_of_chart.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/flat_shape.h"

namespace atlas::test {
namespace {

// A flat band between the radii 1 and 1 + `width` over `share` of a full turn. It is closed if
// `share` is 1.
Shape ring(double width, double share, int around) {
  Shape shape;
  shape.name = "ring";
  const int columns = share < 1 ? around + 1 : around;
  for (int i = 0; i < columns; ++i) {
    const double angle = 2 * M_PI * share * i / around;
    for (const double radius : {1.0, 1 + width / 2, 1 + width}) {
      shape.positions.push_back(
          {float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0});
    }
  }
  for (int i = 0; i < around; ++i) {
    for (int r = 0; r < 2; ++r) {
      const auto a = std::uint32_t(3 * i + r), b = std::uint32_t(3 * ((i + 1) % columns) + r);
      shape.indices.insert(shape.indices.end(), {a, a + 1, b + 1, a, b + 1, b});
    }
  }
  return shape;
}

// Bars of width 1 around n x n holes of width `hole`.
Shape lattice(int n, int hole) {
  const int side = n * (hole + 1) + 1;
  Shape shape = grid(side, side, float(side), float(side));
  std::vector<std::uint32_t> kept;
  for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
    const int x = int(t / 2) % side, y = int(t / 2) / side;
    if (x % (hole + 1) != 0 && y % (hole + 1) != 0) continue;
    kept.insert(kept.end(), &shape.indices[3 * t], &shape.indices[3 * t] + 3);
  }
  shape.indices = kept;
  shape.name = "lattice";
  return shape;
}

TEST(MiddleCut, FramesComeApart) {
  struct Case {
    Shape shape;
    double least_fill;
    std::size_t most_charts;
  };
  const Case cases[] = {{ring(0.2, 1, 96), 0.55, 10},
                        {ring(0.2, 0.95, 96), 0.55, 10},
                        {ring(0.02, 0.97, 400), 0.25, 33},
                        {lattice(2, 9), 0.7, 20},
                        {lattice(3, 12), 0.6, 33}};
  for (const auto& [shape, least_fill, most_charts] : cases) {
    const Mesh mesh(shape);
    const ChartSet whole = checked_charts(mesh, 0),
                   cut = checked_charts(mesh, ChartOptions{}.min_fill);
    EXPECT_EQ(whole.charts.size(), 1u) << shape.name;
    EXPECT_LT(box_fill(whole), 0.4) << shape.name;
    EXPECT_GT(box_fill(cut), least_fill) << shape.name;
    EXPECT_LE(cut.charts.size(), most_charts) << shape.name;
  }
}

TEST(MiddleCut, SievesStayWhole) {
  // The first has too many holes, the second would gain too little.
  for (const Shape& shape : {lattice(12, 6), lattice(9, 3)}) {
    EXPECT_EQ(checked_charts(Mesh(shape), ChartOptions{}.min_fill).charts.size(), 1u);
  }
}

// Returns the length of the edges between different parts, each found by its two vertices.
double length_between(const FlatChart& chart, const std::vector<std::uint32_t>& part_of) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first;
  double length = 0;
  for (std::uint32_t t = 0; t < chart.corners.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = chart.corners[t][k], b = chart.corners[t][(k + 1) % 3];
      const auto [at, fresh] = first.emplace(std::minmax(a, b), part_of[t]);
      if (fresh || at->second == part_of[t]) continue;
      length += std::hypot(chart.uvs[a].x - chart.uvs[b].x, chart.uvs[a].y - chart.uvs[b].y);
    }
  }
  return length;
}

TEST(MiddleCut, GoesTheShortestWay) {
  // A bow tie: two plates and a bridge that is narrowest beside its middle.
  Shape tie = grid(60, 20, 6, 2);
  for (Vec3f& p : tie.positions) {
    p.y = (p.y - 1) * (std::abs(p.x - 3.3f) < 0.15f ? 0.2f : 0.5f + std::abs(p.x - 3.3f));
  }
  const FlatChart charts[] = {as_it_lies(ring(0.1, 1, 90)), as_it_lies(tie)};
  const double known[] = {2 * 0.1, 2 * 0.2};
  for (int i = 0; i < 2; ++i) {
    const FlatChart& chart = charts[i];
    param::HalfEdges half_edges;
    half_edges.build(chart.corners, chart.uvs.size());
    const MiddleCut cut = cut_middle(chart, half_edges, chart.triangles, {1e-4, 1e9});
    ASSERT_EQ(cut.parts.size(), 2u);
    EXPECT_NEAR(cut.length, known[i], 1e-5);
    std::vector<std::uint32_t> part_of(chart.triangles.size(), kNoIndex);
    for (std::uint32_t p = 0; p < cut.parts.size(); ++p) {
      EXPECT_EQ(connected_parts(chart, cut.parts[p]).size(), 1u);
      for (const std::uint32_t t : cut.parts[p]) {
        EXPECT_EQ(part_of[t], kNoIndex);
        part_of[t] = p;
      }
    }
    EXPECT_EQ(std::count(part_of.begin(), part_of.end(), kNoIndex), 0);
    EXPECT_NEAR(length_between(chart, part_of), cut.length, 1e-6);
  }
}

// The halves of a slit ring, one of which falls into two parts, have less sprawl together than the
// whole.
TEST(MiddleCut, KnowsWhatItSaves) {
  const FlatChart chart = as_it_lies(ring(0.05, 0.98, 200));
  param::HalfEdges half_edges;
  half_edges.build(chart.corners, chart.uvs.size());
  const MiddleCut cut = cut_middle(chart, half_edges, chart.triangles, {1e-4, 0.1});
  EXPECT_EQ(cut.parts.size(), 3u);
  EXPECT_GT(cut.fall, 0.5);
}

TEST(MiddleCut, SingleTrianglesStay) {
  const FlatChart chart = as_it_lies(fan(1));
  param::HalfEdges half_edges;
  half_edges.build(chart.corners, chart.uvs.size());
  EXPECT_TRUE(cut_middle(chart, half_edges, chart.triangles, {}).parts.empty());
}

}  // namespace
}  // namespace atlas::test
