// Charts that would leave a page half empty are cut across their limbs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "libatlas/charts/filling/chords.h"
#include "libatlas/charts/flattening/part_of_chart.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// A flat mesh of the letters in `rows` that are not spaces, each of n x n quads. It is bent
// slightly so that no two edges are equal.
Shape letters(const std::vector<std::string>& rows, int n) {
  const int wide = int(rows[0].size()), high = int(rows.size());
  const Shape full = grid(wide * n, high * n, wide, high);
  Shape shape;
  shape.name = rows[0];
  shape.positions = full.positions;
  for (Vec3f& p : shape.positions) {
    const float x = p.x, y = p.y;
    p.x += 0.2f / float(n) * std::sin(7.1f * y + 3 * x);
    p.y += 0.2f / float(n) * std::sin(5.3f * x - 2 * y);
  }
  for (std::size_t t = 0; t < full.triangle_count(); ++t) {
    const std::size_t quad = t / 2, x = quad % std::size_t(wide * n), y = quad / (wide * n);
    if (rows[high - 1 - y / n][x / n] == ' ') continue;
    for (int c = 0; c < 3; ++c) shape.indices.push_back(full.indices[3 * t + c]);
  }
  return shape;
}

Shape star(int points, int rings) {
  Shape shape;
  shape.name = "star";
  shape.positions.push_back({0, 0, 0});
  const int around = 8 * points;
  for (int r = 1; r <= rings; ++r) {
    for (int i = 0; i < around; ++i) {
      const double sawtooth = std::fabs(double(i % 8) / 4 - 1);  // 1 at the tips of the star
      const double radius = (0.35 + 0.65 * sawtooth) * r / rings, angle = 2 * M_PI * i / around;
      shape.positions.push_back(
          {float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0});
    }
  }
  const auto at = [&](int r, int i) { return std::uint32_t(1 + (r - 1) * around + i % around); };
  for (int i = 0; i < around; ++i) {
    shape.indices.insert(shape.indices.end(), {0, at(1, i), at(1, i + 1)});
    for (int r = 1; r < rings; ++r) {
      shape.indices.insert(shape.indices.end(), {at(r, i), at(r + 1, i), at(r + 1, i + 1)});
      shape.indices.insert(shape.indices.end(), {at(r, i), at(r + 1, i + 1), at(r, i + 1)});
    }
  }
  return shape;
}

std::vector<Shape> sprawling() {
  return {letters({"L  ", "L  ", "L  ", "LLL"}, 8),
          letters({"EEE", "E  ", "EE ", "E  ", "EEE"}, 7),
          letters({"X   X", "XX XX", " XXX ", "XX XX", "X   X"}, 6),
          letters({"M M M M M", "M M M M M", "M M M M M", "MMMMMMMMM"}, 5),
          letters({"UUUUU", "U   U", "U   U", "U   U"}, 9),
          letters({"DDDDDDDD", "D      D", "D      D", "D      D", "DDDDDDDD"}, 5),
          letters({"OOOO   ", "O  O   ", "OOOOOOO", "   O  O", "   OOOO"}, 6),
          star(5, 10)};
}

// Uses Jarvis's march.
double hull_area(const std::vector<Vec2d>& points) {
  std::size_t first = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2d &p = points[i], &q = points[first];
    if (p.y < q.y || (p.y == q.y && p.x < q.x)) first = i;
  }
  double twice = 0;
  std::size_t at = first, steps = 0;
  do {
    std::size_t next = at == 0 ? 1 : 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2d &a = points[at], &b = points[next], &c = points[i];
      const double turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      const double far = std::hypot(c.x - a.x, c.y - a.y) - std::hypot(b.x - a.x, b.y - a.y);
      if (turn < -1e-12 || (turn < 1e-12 && far > 0)) next = i;
    }
    const Vec2d &o = points[first], &a = points[at], &b = points[next];
    twice += (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    at = next;
  } while (at != first && ++steps < points.size());
  return 0.5 * twice;
}

double hull_fill(const ChartSet& set) {
  double area = 0, hulls = 0;
  for (const Chart& chart : set.charts) {
    area += chart.distortion.uv_area;
    const auto first = set.uvs.begin() + chart.first_uv;
    hulls += hull_area({first, first + chart.uv_count});
  }
  return area / hulls;
}

ChartSet charts_of(const Mesh& mesh, double min_fill, int threads = 1) {
  Context context;
  context.threads = threads;
  ChartOptions options;
  options.min_fill = min_fill;
  Result<ChartSet> result = make_charts(mesh.view(), options, context);
  EXPECT_TRUE(result.ok()) << result.status().message();
  return result.ok() ? std::move(*result) : ChartSet{};
}

TEST(Limbs, AChartThatSprawlsIsCutUntilItsPiecesFillTheirRectangles) {
  for (const Shape& shape : sprawling()) {
    const Mesh mesh(shape);
    const ChartSet whole = charts_of(mesh, 0), cut = charts_of(mesh, ChartOptions{}.min_fill);
    EXPECT_EQ(whole.charts.size(), 1u) << shape.name;
    const ChartFindings found = check_charts(mesh.view(), cut);
    EXPECT_EQ(found.fault, "") << shape.name;
    EXPECT_NEAR(found.seam, cut.seam_length, 1e-6 * (1 + cut.seam_length)) << shape.name;
    // The star becomes five triangles and a pentagon, which do not fill their rectangles wherever
    // it is cut.
    EXPECT_GT(box_fill(cut), shape.name == "star" ? 0.62 : 0.7) << shape.name;
    EXPECT_LE(cut.charts.size(), 6u) << shape.name;
    EXPECT_LT(cut.distortion.stretch_linf, 1 + 1e-6) << shape.name;
  }
}

// A thin flag of less than a hundredth of a chart's area can double the chart's rectangle.
TEST(Limbs, FlagsAreCutOffHoweverThin) {
  constexpr int n = 12;
  Shape plate = grid(2 * n, 2 * n, 2, 2);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t t = 0; t < plate.triangle_count(); ++t) {
    const int x = int(t / 2) % (2 * n), y = int(t / 2) / (2 * n);
    if (x >= n || y < n) kept.insert(kept.end(), &plate.indices[3 * t], &plate.indices[3 * t] + 3);
  }
  plate.indices = kept;
  for (Vec3f& p : plate.positions) {
    p.x = p.x < 1 ? 10 * p.x : 10 + 0.08f * (p.x - 1);
    p.y *= 9;
  }
  const Mesh mesh(plate);
  const ChartSet whole = charts_of(mesh, 0), cut = charts_of(mesh, 0.72);
  EXPECT_EQ(whole.charts.size(), 1u);
  EXPECT_LT(box_fill(whole), 0.6);
  EXPECT_EQ(check_charts(mesh.view(), cut).fault, "");
  EXPECT_EQ(cut.charts.size(), 2u);
  EXPECT_GT(box_fill(cut), 0.85);
}

TEST(Limbs, WhatIsNotTheWholePageOrFillsItsRectangleStays) {
  for (const Shape& shape : {grid(20, 10), fan(40), cylinder(48, 12), cone(48, 12, 0.4)}) {
    const Mesh mesh(shape);
    EXPECT_EQ(charts_of(mesh, 0).charts.size(), charts_of(mesh, 0.72).charts.size()) << shape.name;
  }
  const Shape small = letters({"L  ", "L  ", "L  ", "LLL"}, 8);
  const Mesh mesh(together(small, moved(grid(20, 10), 10, {20, 0, 0})));
  EXPECT_EQ(charts_of(mesh, 0.72).charts.size(), 2u) << "there is room for an L beside a big plate";
}

// The L covers half of its rectangle, which has an area of 12. The page must hold that rectangle.
TEST(Limbs, ARectangleDecidesWhereItExceedsAllCharts) {
  const Shape l = letters({"L  ", "L  ", "L  ", "LLL"}, 8);
  const auto beside = [&](float side) {
    const Mesh mesh(together(l, moved(grid(9, 9, side, side), 1, {20, 0, 0})));
    return charts_of(mesh, 0.72).charts.size();
  };
  EXPECT_EQ(beside(2.85f), 2u) << "0.85 of all charts' area";
  EXPECT_GT(beside(1.7f), 2u) << "1.35 of it";
}

TEST(Limbs, ManySprawlingChartsAreCutAsFarAsTheyLeaveAPageEmpty) {
  for (const int n : {1, 4}) {
    const Shape one = letters({"L     ", "L     ", "L     ", "LLLLLL"}, n);
    Shape many = one;
    for (int i = 1; i < 12; ++i) many = together(many, moved(one, 1, {7.0 * i, 0, 0}));
    const Mesh mesh(many);
    const ChartSet whole = charts_of(mesh, 0), cut = charts_of(mesh, 0.72);
    EXPECT_EQ(whole.charts.size(), 12u);
    EXPECT_LT(hull_fill(whole), 0.66);
    const ChartFindings found = check_charts(mesh.view(), cut);
    EXPECT_EQ(found.fault, "");
    EXPECT_GT(hull_fill(cut), 0.68 * (1 - 1e-9));
    EXPECT_LT(cut.charts.size(), 24u) << "no more than needed";
  }
}

// Twenty concentric rings, each of which is small beside all of them.
TEST(Limbs, RingsThatNestInEachOtherAreCutLittle) {
  Mesh mesh;
  const Shape band = grid(96, 2, 1, 1);
  for (int i = 0; i < 20; ++i) {
    for (const std::uint32_t v : band.indices)
      mesh.indices.push_back(v + std::uint32_t(mesh.positions.size()));
    for (const Vec3f& p : band.positions) {
      const double angle = 2 * M_PI * p.x, radius = 0.2 + 0.04 * i + 0.012 * (1 - p.y);
      mesh.positions.push_back(
          {float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0.01f * float(i)});
    }
  }
  EXPECT_EQ(charts_of(mesh, 0).charts.size(), 20u);
  EXPECT_LT(charts_of(mesh, 0.72).charts.size(), 240u);
}

TEST(Limbs, EdgesOfACoarseMeshMayBeChords) {
  // An L whose inner corner (point 4) is connected to no other point than its outer corner.
  const std::vector<Vec2d> outline{{0, 0}, {0.7, 0}, {5, 0}, {5, 1}, {1, 1}, {1, 5}, {0, 5}};
  const std::vector<std::array<std::uint32_t, 2>> edges{{0, 4}};
  const auto across = [](const std::vector<Chord>& chords) {
    return std::any_of(chords.begin(), chords.end(),
                       [](const Chord& c) { return c.a == 4 && c.b == 0; });
  };
  EXPECT_FALSE(across(find_chords(outline, {}, 0.1, {})));
  EXPECT_TRUE(across(find_chords(outline, edges, 0.1, {})));
}

TEST(Limbs, PiecesOfACurvedChartKeepToTheBound) {
  Shape shape = letters({"M M M M M", "M M M M M", "M M M M M", "MMMMMMMMM"}, 8);
  for (Vec3f& p : shape.positions) p.z = 0.02f * p.x * p.x + 0.01f * p.y * p.y;
  const Mesh mesh(shape);
  const ChartSet cut = charts_of(mesh, 0.72);
  const ChartFindings found = check_charts(mesh.view(), cut);
  EXPECT_EQ(found.fault, "");
  EXPECT_GT(cut.charts.size(), 1u);
  EXPECT_LE(found.stretch_999, 1.25 * (1 + 1e-6));
  EXPECT_GT(box_fill(cut), 0.65);
}

TEST(Limbs, TheSameForAnyThreadCountAndScale) {
  for (const Shape& shape : sprawling()) {
    const Mesh mesh(shape);
    const ChartSet one = charts_of(mesh, 0.72, 1);
    EXPECT_EQ(bytes(one), bytes(charts_of(mesh, 0.72, 8))) << shape.name;
    const ChartSet large = charts_of(Mesh(moved(shape, 1024)), 0.72);
    EXPECT_EQ(one.triangle_chart, large.triangle_chart) << shape.name;
  }
}

TEST(Limbs, OptionIsChecked) {
  const Mesh mesh(grid(2, 2));
  for (const double fill : {-0.1, 1.0, std::nan("")}) {
    ChartOptions options;
    options.min_fill = fill;
    EXPECT_EQ(make_charts(mesh.view(), options, {}).status().code(), ErrorCode::bad_option);
  }
}

// Triangles that share only a corner, or nothing, are separate parts.
TEST(PartOfChart, WhatHangsTogetherByWholeSides) {
  FlatChart chart;  // four squares of two triangles in a row; corners are ordered by column and row
  for (std::uint32_t x = 0; x < 4; ++x) {
    const std::uint32_t a = 2 * x, b = a + 2;
    for (const auto& corners : {std::array{a, b, a + 1}, std::array{b, b + 1, a + 1}}) {
      chart.triangles.push_back(std::uint32_t(chart.triangles.size()));
      chart.corners.push_back(corners);
    }
  }
  for (int v = 0; v < 10; ++v) chart.uvs.push_back({double(v / 2), double(v % 2)});
  const auto parts = [&](const std::vector<std::uint32_t>& triangles) {
    return connected_parts(chart, triangles);
  };
  using Parts = std::vector<std::vector<std::uint32_t>>;
  EXPECT_EQ(parts({0, 1, 2, 3, 4, 5, 6, 7}), (Parts{{0, 1, 2, 3, 4, 5, 6, 7}}));
  EXPECT_EQ(parts({0, 2, 3}), (Parts{{0}, {2, 3}}));  // 0 and 2 share only a corner
  EXPECT_EQ(parts({1, 2, 6, 7}), (Parts{{1, 2}, {6, 7}}));
}

// Two columns of squares that are joined at the far end only: one part, its triangles ascending.
TEST(PartOfChart, TrianglesOfAPartAreAscending) {
  const Shape shape = grid(3, 6);
  FlatChart chart;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < shape.triangle_count(); ++t) {
    chart.triangles.push_back(t);
    chart.corners.push_back(
        {shape.indices[3 * t], shape.indices[3 * t + 1], shape.indices[3 * t + 2]});
    const bool between = t / 2 % 3 == 1 && t / 6 < 5;
    if (!between) triangles.push_back(t);
  }
  for (const Vec3f& p : shape.positions) chart.uvs.push_back({p.x, p.y});
  EXPECT_EQ(connected_parts(chart, triangles), std::vector<std::vector<std::uint32_t>>{triangles});
}

// All of a chart as its own part is stretched as it was, also where the density varies.
TEST(PartOfChart, KnowsItsStretch) {
  const Mesh mesh(grid(40, 8, 5, 1));
  const Topology topology = topology_of(mesh);
  std::vector<float> density;
  std::vector<std::uint32_t> all;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    density.push_back(std::exp2(mesh.positions[mesh.indices[3 * t]].x / 5));
    all.push_back(t);
  }
  Partition partition;
  partition.chart.assign(all.size(), 0);
  Frames none;
  const ChartOptions options;
  const FlattenInput input{topology, density, options, none};
  const FlattenResult flat = flatten_charts(input, partition, {});
  ASSERT_EQ(flat.charts.size(), 1u);
  const FlatChart part = part_of_chart(input, flat.charts[0], all);
  const Distortion &a = flat.charts[0].distortion, &b = part.distortion;
  EXPECT_LT(a.stretch_999, 1.1);
  EXPECT_NEAR(b.stretch_999, a.stretch_999, 1e-6);
  EXPECT_NEAR(b.stretch_l2, a.stretch_l2, 1e-6);
  EXPECT_NEAR(b.surface_area, a.surface_area, 1e-6 * a.surface_area);
  EXPECT_NEAR(b.uv_area, a.uv_area, 1e-6 * a.uv_area);
}

}  // namespace
}  // namespace atlas::test
