#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/simplify/exact_slip.h"
#include "tests/simplify/expect_sound.h"

namespace atlas {
namespace {

using namespace simplify_test;

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
    EXPECT_LT(coarse.triangles_out, mesh.triangles() / (density < 30 ? 5 : 2)) << density;
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
    EXPECT_LT(coarse.triangles_out, mesh.triangles() / 5) << density;
  }
}

TEST(Simplify, WallsThatShareANonManifoldEdge) {
  const ChartedMesh mesh = partition(20);
  const SimplifiedMesh coarse = simplify(mesh, 100);
  expect_sound(mesh, coarse, 100);
  EXPECT_EQ(coarse.triangles_out, 6U);
}

TEST(Simplify, AWallStaysOnItsFloor) {
  for (const double amplitude : {0.0, 0.1}) {
    const ChartedMesh mesh = wall_on_field(32, amplitude);
    const SimplifiedMesh coarse = simplify(mesh, 50);
    expect_sound(mesh, coarse, 50);
    EXPECT_LT(coarse.triangles_out, amplitude > 0 ? mesh.triangles() / 5 : 12);
  }
}

TEST(Simplify, AWallStaysOnItsFloorAtTheOrigin) {
  ChartedMesh mesh = wall_on_field(32, 0.1);
  const auto under = std::find_if(mesh.positions.begin(), mesh.positions.end(),
                                  [](const Vec3f& p) { return p.x == 0.5F && p.y == 0.5F; });
  ASSERT_NE(under, mesh.positions.end());
  const Vec3f foot = *under;
  for (Vec3f& p : mesh.positions) p = {p.x - foot.x, p.y - foot.y, p.z - foot.z};
  const SimplifiedMesh coarse = simplify(mesh, 50);
  expect_sound(mesh, coarse, 50);
  EXPECT_LT(coarse.triangles_out, mesh.triangles() / 5);
}

TEST(Simplify, ChartsThatMeetThemselves) {
  const ChartedMesh ring = torus(24), band = moebius(12);
  const SimplifiedMesh coarse_ring = simplify(ring, 8), coarse_band = simplify(band, 8);
  expect_sound(ring, coarse_ring, 8);
  expect_sound(band, coarse_band, 8);
  EXPECT_LT(coarse_ring.triangles_out, ring.triangles() / 4);
  EXPECT_LT(coarse_band.triangles_out, band.triangles() / 4);
  // Both sides of a cut keep the same vertices.
  EXPECT_EQ(open_edges(ring.positions, coarse_ring.indices).count, 0U);
}

TEST(Simplify, BothSidesOfAPlate) {
  const ChartedMesh mesh = two_sided(20);
  const SimplifiedMesh coarse = simplify(mesh, 100);
  expect_sound(mesh, coarse, 100);
  EXPECT_EQ(coarse.triangles_out, 4U);
}

TEST(Simplify, OpenBordersThatShareSomePoints) {
  const ChartedMesh mesh = touching_plates(24, 16);
  const SimplifiedMesh coarse = simplify(mesh, 200);
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
  EXPECT_EQ(coarse.triangles_out, 4U);
}

TEST(Simplify, ChartsOfDifferentDensity) {
  const ChartedMesh mesh = sphere(24);
  const std::vector<double> densities = {10, 200, 30, 60, 15, 100};
  auto result = simplify_charts({mesh.view(), mesh.charts, densities}, {}, {});
  ASSERT_TRUE(result.ok());
  expect_sound(mesh, *result, densities);
  std::vector<std::size_t> count(6, 0);
  for (const std::uint32_t c : result->triangle_chart) ++count[c];
  EXPECT_GT(count[1], 4 * count[0]);
}

TEST(Simplify, ABoundOfItsOwn) {
  const ChartedMesh mesh = bumpy(48, 0.05);
  std::size_t last = mesh.triangles() + 1;
  for (const double slip : {0.01, 0.1, 0.5, 2.0}) {
    SimplifyOptions options;
    options.max_slip_texels = slip;
    const SimplifiedMesh coarse = simplify(mesh, 200, options);
    expect_sound(mesh, coarse, 200, options);
    EXPECT_LT(coarse.triangles_out, last);
    last = coarse.triangles_out;
  }
}

// Texels are so large here that the turn decides. Entire fine triangles are wider than the strips
// that do not count.
TEST(Simplify, ATurnOfItsOwn) {
  const ChartedMesh mesh = sphere(32);
  std::size_t last = mesh.triangles() + 1;
  for (const double turn : {8.0, 14.0, 22.0}) {
    SimplifyOptions options;
    options.max_turn_degrees = turn;
    const SimplifiedMesh coarse = simplify(mesh, 6, options);
    const ExactSlip exact = exact_slip(mesh, coarse, 6);
    EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
    EXPECT_LE(coarse.max_turn_degrees, turn);
    EXPECT_LE(exact.turn, coarse.max_turn_degrees + 1e-6);
    EXPECT_LE(exact.inside, coarse.max_slip_texels + 1e-6);
    EXPECT_LT(coarse.triangles_out, last);
    last = coarse.triangles_out;
  }
}

TEST(Simplify, ScaleFree) {
  const ChartedMesh mesh = sphere(16);
  ChartedMesh large = mesh;
  constexpr float kScale = 1024;
  for (Vec3f& p : large.positions) p = {kScale * p.x, kScale * p.y, kScale * p.z};
  for (Vec2d& u : large.charts.uvs) u = {kScale * u.x, kScale * u.y};
  EXPECT_EQ(simplify(mesh, 64).uv_indices, simplify(large, 64.0 / kScale).uv_indices);
}

TEST(Simplify, PlaceFree) {
  ChartedMesh mesh = bumpy(32, 0.05);
  const auto on_grid = [](float x) { return std::round(x * 4096) / 4096; };  // exact when moved
  for (Vec3f& p : mesh.positions) p = {on_grid(p.x), on_grid(p.y), on_grid(p.z)};
  ChartedMesh moved = mesh;
  for (Vec3f& p : moved.positions) p = {p.x + 256, p.y - 512, p.z + 64};
  EXPECT_EQ(simplify(mesh, 64).uv_indices, simplify(moved, 64).uv_indices);
}

// Charts of random outline over a height field: seams of every kind, points where many charts meet,
// charts with several parts that touch at points, and holes.
TEST(Simplify, Patchworks) {
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(seed);
    const ChartedMesh mesh = patchwork(28, static_cast<int>(seed % 4), seed % 3 * 0.04, seed);
    const SimplifiedMesh coarse = simplify(mesh, 60);
    expect_sound(mesh, coarse, 60);
    EXPECT_LT(coarse.triangles_out, mesh.triangles());
  }
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
