#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "tests/simplify/checks.h"

namespace atlas {
namespace {

using namespace simplify_test;

SimplifiedMesh simplify(const ChartedMesh& mesh, double density,
                        const SimplifyOptions& options = {}, const Context& context = {}) {
  const std::vector<double> densities(mesh.charts.charts.size(), density);
  auto result = simplify_charts(mesh.view(), mesh.charts, densities, options, context);
  EXPECT_TRUE(result.ok()) << result.status().message();
  return result.ok() ? std::move(*result) : SimplifiedMesh{};
}

// What holds for every mesh without defects.
void expect_sound(const ChartedMesh& mesh, const SimplifiedMesh& coarse, double density,
                  const SimplifyOptions& options = {}) {
  EXPECT_EQ(coarse.triangles_in, mesh.triangles());
  EXPECT_EQ(coarse.triangles_out, coarse.triangle_chart.size());
  EXPECT_EQ(coarse.indices.size(), 3 * coarse.triangle_chart.size());
  EXPECT_EQ(coarse.uv_indices.size(), coarse.indices.size());
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  const OpenEdges before = open_edges(mesh.positions, mesh.indices),
                  after = open_edges(mesh.positions, coarse.indices);
  EXPECT_LE(after.count, before.count);
  EXPECT_NEAR(after.length, before.length, 1e-3 * before.length);
  const std::vector<double> densities(mesh.charts.charts.size(), density);
  const SampledSlip slip = sample_slip(mesh, coarse, densities, 12);
  std::printf(
      "%zu -> %zu triangles, slip %.4f (sampled %.4f, outside %.4f, share %.4f), turn %.1f, %.3f "
      "s\n",
      mesh.triangles(), coarse.triangle_chart.size(), coarse.max_slip_texels, slip.inside,
      slip.outside, slip.outside_share, coarse.max_turn_degrees, coarse.cpu_seconds);
  EXPECT_LE(slip.inside, coarse.max_slip_texels + 1e-6);
  EXPECT_LE(slip.outside, options.max_slip_texels * 1.000001);
  EXPECT_LE(coarse.max_slip_texels, options.max_slip_texels);
  EXPECT_LE(coarse.max_turn_degrees, options.max_turn_degrees);
  EXPECT_GE(slip.least_cosine, std::cos(options.max_turn_degrees * 3.14159265 / 180) - 1e-6);
}

TEST(Simplify, BoxBecomesTwelveTriangles) {
  const ChartedMesh mesh = box(24);
  const SimplifiedMesh coarse = simplify(mesh, 200);
  expect_sound(mesh, coarse, 200);
  EXPECT_EQ(coarse.triangles_out, 12U);
}

TEST(Simplify, PlateWithHole) {
  const ChartedMesh mesh = plate_with_hole(30);
  const SimplifiedMesh coarse = simplify(mesh, 200);
  expect_sound(mesh, coarse, 200);
  EXPECT_LE(coarse.triangles_out, 8U);
  EXPECT_NEAR(uv_area(mesh, coarse), 8.0 / 9, 1e-9);
}

TEST(Simplify, Sphere) {
  const ChartedMesh mesh = sphere(32);
  for (const double density : {20.0, 60.0, 200.0}) {
    const SimplifiedMesh coarse = simplify(mesh, density);
    expect_sound(mesh, coarse, density);
    if (density < 30) {
      EXPECT_LT(coarse.triangles_out, mesh.triangles() / 5);
    }
  }
}

TEST(Simplify, CutCylinder) {
  for (const bool cut : {true, false}) {
    const ChartedMesh mesh = cylinder(64, cut);
    const SimplifiedMesh coarse = simplify(mesh, 30);
    expect_sound(mesh, coarse, 30);
    EXPECT_LT(coarse.triangles_out, mesh.triangles() / 10);
  }
}

TEST(Simplify, BumpyField) {
  const ChartedMesh mesh = bumpy(96, 0.05);
  for (const double density : {50.0, 300.0}) {
    const SimplifiedMesh coarse = simplify(mesh, density);
    expect_sound(mesh, coarse, density);
  }
}

TEST(Simplify, WallsThatShareANonManifoldEdge) {
  const ChartedMesh mesh = partition(20);
  const SimplifiedMesh coarse = simplify(mesh, 100);
  expect_sound(mesh, coarse, 100);
  EXPECT_EQ(coarse.triangles_out, 6U);
}

TEST(Simplify, SameForEveryThreadCount) {
  const ChartedMesh mesh = sphere(24);
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  const SimplifiedMesh a = simplify(mesh, 40, {}, one), b = simplify(mesh, 40, {}, four);
  EXPECT_EQ(a.indices, b.indices);
  EXPECT_EQ(a.uv_indices, b.uv_indices);
  EXPECT_EQ(a.source_triangle, b.source_triangle);
}

}  // namespace
}  // namespace atlas
