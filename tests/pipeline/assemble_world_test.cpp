#include "libatlas/pipeline/assemble_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/flat_mesh.h"

namespace atlas::test {
namespace {

// A unit square of two triangles on a page of 64 texels. The second triangle is later given
// clockwise uvs.
TEST(AssembleWorld, TellsOfTrianglesThatStayTurnedOver) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  scene.indices = {0, 1, 2, 0, 2, 3};
  ChartSet charts;
  charts.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  charts.triangle_uv = {0, 1, 2, 0, 2, 3};
  charts.triangle_chart = {0, 0};
  charts.charts.resize(1);
  charts.charts[0].triangle_count = 2;
  charts.charts[0].uv_count = 4;
  ChartPlacement placement;
  placement.page = 0;
  placement.x = placement.y = 4;
  placement.width = placement.height = 56;
  placement.texels_per_unit = {56, 56};
  turn_in_box(placement, false);
  const Extent page{64, 64};
  const auto thin = [&] {
    const WorldMesh mesh{scene.indices, charts.triangle_uv, charts.triangle_chart};
    const AssembledWorld made =
        assemble_world(scene, {charts, {&placement, 1}, {&page, 1}}, mesh, true);
    EXPECT_EQ(made.world.pages[0].indices, scene.indices);
    EXPECT_NEAR(made.world.uvs[2].x, 60.0 / 64, 1.1 / 64);  // at most one texel off
    return made.thin_triangles;
  };
  EXPECT_EQ(thin(), 0u);
  std::swap(charts.triangle_uv[4], charts.triangle_uv[5]);
  EXPECT_EQ(thin(), 1u);
  EXPECT_TRUE(thin_triangles_text(1, 2).starts_with("1 of 2 triangles are so thin"));
}

// Returns how far corners of slivers that lean on each other move along an axis, as a share of the
// page, when they are rounded on a page of this size.
double farthest_move(Extent page, bool baked) {
  const FlatMesh mesh = leaning_slivers();
  Scene scene;
  scene.positions.resize(mesh.uvs.size());
  ChartSet charts;
  charts.uvs = mesh.uvs;
  charts.triangle_uv = mesh.corners;
  charts.triangle_chart.assign(mesh.corners.size() / 3, 0);
  charts.charts.resize(1);
  charts.charts[0].triangle_count = std::uint32_t(mesh.corners.size() / 3);
  charts.charts[0].uv_count = std::uint32_t(mesh.uvs.size());
  ChartPlacement placement;
  placement.page = 0;
  placement.texels_per_unit = {double(page.width), double(page.height)};
  turn_in_box(placement, false);
  const AssembledWorld made =
      assemble_world(scene, {charts, {&placement, 1}, {&page, 1}},
                     {charts.triangle_uv, charts.triangle_uv, charts.triangle_chart}, baked);
  double most = 0;
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    most = std::max({most, std::fabs(made.world.uvs[i].x - mesh.uvs[i].x),
                     std::fabs(made.world.uvs[i].y - mesh.uvs[i].y)});
  }
  return most;
}

// Pages without images have no light that could be missed.
TEST(AssembleWorld, OnlyOnBakedPagesUvsStayWithinATexel) {
  constexpr std::int32_t kLong = 16384;
  const double texel = 1.0 / kLong, rounding = 0x1p-24;
  for (const Extent page : {Extent{kLong, 64}, Extent{64, kLong}}) {
    EXPECT_LE(farthest_move(page, true), texel + rounding);
    EXPECT_GT(farthest_move(page, false), 1.5 * texel) << "the test is too easy";
  }
}

}  // namespace
}  // namespace atlas::test
