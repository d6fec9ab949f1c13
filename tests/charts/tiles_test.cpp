// Charts that are cut to a maximum length.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "libatlas/charts/tiles.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

constexpr double kMaxStretch = ChartOptions{}.max_stretch;

ChartSet usual_charts(const Mesh& mesh) {
  auto charts = make_charts(mesh.view(), {}, {});
  EXPECT_TRUE(charts.ok()) << charts.status().message();
  return std::move(*charts);
}

double longest(const ChartSet& set) {
  double length = 0;
  for (const Chart& chart : set.charts) length = std::max(length, chart.size.x);
  return length;
}

std::size_t cut(const Mesh& mesh, double limit, ChartSet& set) {
  const std::vector<double> sides(set.charts.size(), limit);
  const auto count = cut_to_limits(mesh.view(), {sides, kMaxStretch}, set, {});
  EXPECT_TRUE(count.ok()) << count.status().message();
  return *count;
}

double longest_edge(const Mesh& mesh, std::uint32_t t) {
  double length = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3f a = mesh.positions[mesh.indices[3 * t + k]],
                b = mesh.positions[mesh.indices[3 * t + (k + 1) % 3]];
    length = std::max(length, std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z));
  }
  return length;
}

TEST(Tiles, KeepWhatChartsPromise) {
  for (const Shape& shape : zoo()) {
    const Mesh mesh(shape);
    const ChartSet whole = usual_charts(mesh);
    for (const double share : {0.7, 0.3}) {
      const double limit = share * longest(whole);
      ChartSet pieces = whole;
      const std::size_t count = cut(mesh, limit, pieces);
      const ChartFindings found = check_charts(mesh.view(), pieces);
      EXPECT_EQ(found.fault, "") << shape.name << ' ' << share;
      EXPECT_LE(found.stretch_999, kMaxStretch * (1 + 1e-6)) << shape.name << ' ' << share;
      EXPECT_NEAR(found.seam, pieces.seam_length, 1e-4 * (1 + found.seam)) << shape.name;
      EXPECT_NEAR(found.stretch_l2, pieces.distortion.stretch_l2, 1e-3) << shape.name;
      EXPECT_EQ(count > 0, pieces.charts.size() > whole.charts.size()) << shape.name;
      for (const Chart& chart : pieces.charts) {
        if (chart.size.x <= limit * (1 + 1e-9)) continue;
        double edge = 0;
        for (std::uint32_t i = 0; i < chart.triangle_count; ++i)
          edge =
              std::max(edge, longest_edge(mesh, pieces.chart_triangles[chart.first_triangle + i]));
        EXPECT_GT(edge, limit / kMaxStretch) << shape.name << ": more than one triangle too long";
      }
    }
  }
}

TEST(Tiles, AreTheSameForEveryNumberOfThreads) {
  Shape many = grid(120, 5, 40, 1);
  for (int i = 1; i < 12; ++i)
    many = together(many, moved(grid(60 + 20 * i, 4, 20 + i, 0.7), 1, {0, 2.0 * i, 0}));
  const Mesh mesh(many);
  const ChartSet whole = usual_charts(mesh);
  const std::vector<double> sides(whole.charts.size(), 6.5);
  ChartSet sets[2] = {whole, whole};
  for (const int threads : {1, 4}) {
    Context context;
    context.threads = threads;
    const auto count = cut_to_limits(mesh.view(), {sides, kMaxStretch}, sets[threads > 1], context);
    ASSERT_TRUE(count.ok());
    EXPECT_EQ(*count, whole.charts.size());
  }
  EXPECT_EQ(sets[0].triangle_uv, sets[1].triangle_uv);
  EXPECT_EQ(sets[0].triangle_chart, sets[1].triangle_chart);
  EXPECT_EQ(sets[0].seam_length, sets[1].seam_length);
  ASSERT_EQ(sets[0].uvs.size(), sets[1].uvs.size());
  for (std::size_t i = 0; i < sets[0].uvs.size(); ++i) {
    ASSERT_EQ(sets[0].uvs[i].x, sets[1].uvs[i].x);
    ASSERT_EQ(sets[0].uvs[i].y, sets[1].uvs[i].y);
  }
}

TEST(Tiles, OnceCancelledChartsAreWhatTheyWere) {
  const Mesh mesh(grid(200, 5, 40, 1));
  ChartSet set = usual_charts(mesh);
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const std::vector<double> sides(set.charts.size(), 10.5);
  const auto count = cut_to_limits(mesh.view(), {sides, kMaxStretch}, set, context);
  EXPECT_EQ(count.status().code(), ErrorCode::cancelled);
  EXPECT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
}

// Of charts across materials, each piece tells the material of its own first triangle.
TEST(Tiles, TellTheMaterialOfTheirFirstTriangle) {
  Mesh mesh(grid(200, 5, 40, 1));
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const Vec3f corner = mesh.positions[mesh.indices[3 * t]];
    mesh.materials.push_back(std::uint32_t(corner.x / 10));
  }
  ChartOptions options;
  options.split_at_materials = false;
  auto set = make_charts(mesh.view(), options, {});
  ASSERT_TRUE(set.ok());
  ASSERT_EQ(set->charts.size(), 1u);
  EXPECT_EQ(cut(mesh, 10.5, *set), 1u);
  EXPECT_EQ(set->charts.size(), 4u);
  for (const Chart& chart : set->charts)
    EXPECT_EQ(chart.material, mesh.materials[set->chart_triangles[chart.first_triangle]]);
}

// Each cut of a regular strip runs straight across it.
TEST(Tiles, AreCutAcross) {
  const Mesh mesh(grid(200, 5, 40, 1));
  ChartSet set = usual_charts(mesh);
  ASSERT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(cut(mesh, 10.5, set), 1u);
  EXPECT_EQ(set.charts.size(), 4u);
  EXPECT_NEAR(set.seam_length, 3, 1e-3);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
}

// The parts of what is as long as its triangles would be just as long. A disc was cut into single
// triangles. A square wall still is, whose triangles need few texels each.
TEST(Tiles, AreNotMuchShorterThanTheirTriangles) {
  for (const int n : {64, 200, 1000}) {
    const Mesh mesh(fan(n));
    ChartSet set = usual_charts(mesh);
    ASSERT_EQ(set.charts.size(), 1u);
    EXPECT_EQ(cut(mesh, 0.1 * longest(set), set), 1u);
    EXPECT_GE(set.charts.size(), 4u) << n;
    EXPECT_LE(set.charts.size(), 6u) << n;
    EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
  }
  const Mesh wall(grid(1, 1));
  ChartSet set = usual_charts(wall);
  EXPECT_EQ(cut(wall, 0.1, set), 1u);
  EXPECT_EQ(set.charts.size(), 2u);
}

// A long needle does not keep the small triangles beside it together.
TEST(Tiles, OfSmallTrianglesFitBesideANeedle) {
  Mesh mesh(grid(60, 6, 10, 1));
  const std::uint32_t tip = std::uint32_t(mesh.positions.size());
  mesh.positions.push_back({10, -0.1f, 0});
  for (const std::uint32_t v : {1u, 0u, tip}) mesh.indices.push_back(v);
  ChartSet set = usual_charts(mesh);
  ASSERT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(cut(mesh, 2, set), 1u);
  std::size_t within = 0;
  for (const Chart& chart : set.charts)
    if (chart.size.x <= 2) within += chart.triangle_count;
  EXPECT_GE(within, 700u);  // of 721
}

// Returns the area of the smallest box around a chart, of 900 directions.
double smallest_box(const ChartSet& set, const Chart& chart) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 900; ++k) {
    const double c = std::cos(k * M_PI / 1800), s = std::sin(k * M_PI / 1800);
    glm::dvec2 low(1e30), high(-1e30);
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
      const glm::dvec2 p(c * set.uvs[i].x + s * set.uvs[i].y, c * set.uvs[i].y - s * set.uvs[i].x);
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    smallest = std::min(smallest, (high.x - low.x) * (high.y - low.y));
  }
  return smallest;
}

// An arc's pieces have directions of their own, and would lie across their boxes.
TEST(Tiles, EachPieceIsTurnedForPacking) {
  Mesh mesh(grid(240, 3, 1, 1));
  for (Vec3f& p : mesh.positions) {
    const double angle = 5 * double(p.x), radius = 1 + 0.05 * double(p.y);
    p = {float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0};
  }
  ChartOptions options;
  options.min_fill = 0;
  auto charts = make_charts(mesh.view(), options, {});
  ASSERT_TRUE(charts.ok());
  ASSERT_EQ(charts->charts.size(), 1u);
  EXPECT_EQ(cut(mesh, 0.6, *charts), 1u);
  EXPECT_GE(charts->charts.size(), 8u);
  for (const Chart& chart : charts->charts)
    EXPECT_LE(chart.size.x * chart.size.y, 1.021 * smallest_box(*charts, chart));
  EXPECT_EQ(check_charts(mesh.view(), *charts).fault, "");
}

TEST(Tiles, WhatIsWithinItsLimitStays) {
  const Mesh mesh(together(grid(9, 9), moved(grid(100, 4, 20, 0.5), 1, {0, 2, 0})));
  const ChartSet whole = usual_charts(mesh);
  ChartSet set = whole;
  EXPECT_EQ(cut(mesh, 1000, set), 0u);
  EXPECT_EQ(bytes(set), bytes(whole));
}

// A spike of less than a thousandth of a sheet may stretch beyond the bound, but not in a small
// piece of it.
Mesh spike() {
  Mesh sheet(grid(60, 60));
  for (Vec3f& p : sheet.positions) p.z = 0.2f * (p.x * p.x - p.y * p.y);
  sheet.positions[61 * 30 + 30].z += 0.014f;
  return sheet;
}

TEST(Tiles, APieceKeepsToTheBoundThatTheWholeKeeps) {
  const Mesh mesh = spike();
  ChartSet set = usual_charts(mesh);
  ASSERT_EQ(set.charts.size(), 1u);
  ASSERT_GT(set.charts[0].distortion.stretch_linf, 1.3);
  EXPECT_EQ(cut(mesh, 0.15, set), 1u);
  const ChartFindings found = check_charts(mesh.view(), set);
  EXPECT_EQ(found.fault, "");
  EXPECT_LE(found.stretch_999, kMaxStretch * (1 + 1e-6));
}

double uv_edge(const ChartSet& set, std::size_t corner) {
  const Vec2d a = set.uvs[set.triangle_uv[corner]],
              b = set.uvs[set.triangle_uv[corner % 3 == 2 ? corner - 2 : corner + 1]];
  return std::hypot(a.x - b.x, a.y - b.y);
}

// The pieces keep their shape, however much they stretch.
TEST(Tiles, PiecesOfGivenChartsKeepTheirShape) {
  Mesh mesh(grid(24, 6, 4, 1));
  for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x / 4, p.y / 12});
  mesh.texcoord_indices = mesh.indices;
  auto given = make_charts(mesh.view(), {.keep_uv_charts = true}, {});
  ASSERT_TRUE(given.ok()) << given.status().message();
  ASSERT_EQ(given->charts.size(), 1u);
  ASSERT_GT(given->charts[0].distortion.stretch_999, 1.5);
  ChartSet pieces = *given;
  EXPECT_EQ(cut(mesh, given->charts[0].size.x / 3.5, pieces), 1u);
  EXPECT_EQ(pieces.charts.size(), 4u);
  for (const Chart& chart : pieces.charts) EXPECT_TRUE(chart.kept);
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner)
    ASSERT_NEAR(uv_edge(pieces, corner), uv_edge(*given, corner), 1e-9);
}

// So does a piece with the spike of a given chart that keeps to the bound.
TEST(Tiles, PiecesOfGivenChartsKeepTheirShapeBeyondTheBound) {
  Mesh mesh = spike();
  const ChartSet own = usual_charts(mesh);
  for (const Vec2d& uv : own.uvs) mesh.texcoords.push_back({float(uv.x), float(uv.y)});
  mesh.texcoord_indices = own.triangle_uv;
  const auto given = make_charts(mesh.view(), {.keep_uv_charts = true}, {});
  ASSERT_TRUE(given.ok()) << given.status().message();
  ASSERT_EQ(given->repairs.kept_charts, 1u);
  ASSERT_LE(given->charts[0].distortion.stretch_999, kMaxStretch);
  ChartSet pieces = *given;
  EXPECT_EQ(cut(mesh, 0.15, pieces), 1u);
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner)
    ASSERT_NEAR(uv_edge(pieces, corner), uv_edge(*given, corner), 1e-9);
}

// Pieces are measured at scales of their own, and so is the whole.
TEST(Tiles, TheWholeIsMeasuredAnew) {
  Mesh mesh(grid(24, 6, 4, 1));
  for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x * p.x / 16 + p.x / 20, p.y});
  mesh.texcoord_indices = mesh.indices;
  const auto given = make_charts(mesh.view(), {.keep_uv_charts = true}, {});
  ASSERT_TRUE(given.ok()) << given.status().message();
  ChartSet pieces = *given;
  EXPECT_EQ(cut(mesh, given->charts[0].size.x / 3.5, pieces), 1u);
  const ChartFindings found = check_charts(mesh.view(), pieces);
  EXPECT_EQ(found.fault, "");
  EXPECT_NEAR(pieces.distortion.stretch_999, found.stretch_999, 1e-4);
  EXPECT_NEAR(pieces.distortion.stretch_l2, found.stretch_l2, 1e-4);
  EXPECT_GT(given->distortion.stretch_999, found.stretch_999 + 0.01);
}

TEST(Tiles, LimitsOutOfRangeChangeNothing) {
  const Mesh mesh(grid(60, 6, 10, 1));
  ChartSet set = usual_charts(mesh);
  const std::size_t count = set.charts.size();
  const auto code = [&](const std::vector<double>& sides, double max_stretch) {
    const auto cut = cut_to_limits(mesh.view(), {sides, max_stretch}, set, {});
    return cut.ok() ? ErrorCode::ok : cut.status().code();
  };
  EXPECT_EQ(code({}, kMaxStretch), ErrorCode::bad_input);
  EXPECT_EQ(code(std::vector<double>(count, 0), kMaxStretch), ErrorCode::bad_input);
  for (const double stretch : {1.0, 0.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(code(std::vector<double>(count, 2.6), stretch), ErrorCode::bad_option) << stretch;
  EXPECT_EQ(set.charts.size(), count);
}

// Triangles that are turned against their chart stay so in its pieces.
TEST(Tiles, MayHaveTurnedTriangles) {
  Mesh mesh(grid(60, 6, 10, 1));
  for (std::size_t i = 0; i < mesh.indices.size(); i += 9)
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  ChartSet set = usual_charts(mesh);
  const std::vector<std::uint32_t> turned = set.flipped_triangles;
  ASSERT_FALSE(turned.empty());
  EXPECT_EQ(cut(mesh, 2.6, set), 1u);
  EXPECT_EQ(set.charts.size(), 4u);
  EXPECT_EQ(set.flipped_triangles, turned);
  EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
}

// A plate whose density doubles along it stretches only as seen without the density. Its pieces are
// as large as they were in the whole, and know how much they stretch.
TEST(Tiles, KeepTheDensityOfTheWhole) {
  const Mesh mesh(grid(80, 8, 10, 1));
  std::vector<float> density;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t)
    density.push_back(std::exp2(mesh.positions[mesh.indices[3 * t]].x / 5));
  MeshView view = mesh.view();
  view.density = density;
  const auto whole = make_charts(view, {}, {});
  ASSERT_TRUE(whole.ok());
  ASSERT_EQ(whole->charts.size(), 1u);
  ASSERT_LT(whole->distortion.stretch_999, 1.1);
  ChartSet set = *whole;
  const std::vector<double> sides{set.charts[0].size.x / 2.5};
  ASSERT_TRUE(cut_to_limits(view, {sides, 1.1}, set, {}).ok());
  EXPECT_EQ(set.charts.size(), 3u);
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner)
    ASSERT_NEAR(uv_edge(set, corner), uv_edge(*whole, corner), 1e-9);
  EXPECT_NEAR(set.distortion.stretch_l2, whole->distortion.stretch_l2, 1e-3);
  EXPECT_NEAR(set.distortion.surface_area, whole->distortion.surface_area,
              1e-9 * whole->distortion.surface_area);
}

// Triangles without area go to the piece that their edge or corner belongs to.
TEST(Tiles, TakeTrianglesWithoutAreaAlong) {
  Shape sheet = grid(40, 4, 10, 1);
  const auto vertex = [](int x, int y) { return std::uint32_t(41 * y + x); };
  for (int x = 1; x < 40; x += 3) {
    const std::uint32_t a = vertex(x, 2), b = vertex(x + 1, 2);
    sheet.indices.insert(sheet.indices.end(), {a, b, b, a, a, a});
  }
  for (const bool first : {false, true}) {
    Mesh mesh(sheet);
    if (first) std::reverse(mesh.indices.begin(), mesh.indices.end());
    ChartSet set = usual_charts(mesh);
    ASSERT_GT(set.repairs.degenerate_triangles, 20u);
    EXPECT_EQ(cut(mesh, 2.6, set), 1u);
    EXPECT_EQ(set.charts.size(), 4u);
    EXPECT_EQ(check_charts(mesh.view(), set).fault, "");
    for (std::size_t i = 0; i < mesh.indices.size(); ++i)
      EXPECT_EQ(mesh.positions[set.uv_vertex[set.triangle_uv[i]]], mesh.positions[mesh.indices[i]]);
  }
}

}  // namespace
}  // namespace atlas::test
