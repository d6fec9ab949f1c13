#include "libatlas/uvs/finish_uvs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/flat_mesh.h"

namespace atlas::test {
namespace {

// One chart of this mesh.
ChartSet charts_of(const FlatMesh& mesh) {
  ChartSet charts;
  charts.uvs = mesh.uvs;
  charts.triangle_uv = mesh.corners;
  charts.triangle_chart.assign(mesh.corners.size() / 3, 0);
  for (std::uint32_t t = 0; t < mesh.corners.size() / 3; ++t) charts.chart_triangles.push_back(t);
  charts.charts.resize(1);
  charts.charts[0].triangle_count = std::uint32_t(mesh.corners.size() / 3);
  charts.charts[0].uv_count = std::uint32_t(mesh.uvs.size());
  return charts;
}

// A unit square of two triangles on a page of 64 texels. The second triangle is later given
// clockwise uvs.
TEST(FinishUvs, TellsOfTrianglesThatStayTurnedOver) {
  FlatMesh mesh;
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.corners = {0, 1, 2, 0, 2, 3};
  ChartPlacement placement;
  placement.page = 0;
  placement.x = placement.y = 4;
  placement.width = placement.height = 56;
  placement.texels_per_unit = {56, 56};
  turn_in_box(placement, false);
  const Extent page{64, 64};
  const auto thin = [&] {
    const ChartSet charts = charts_of(mesh);
    const FinishedUvs made =
        finish_uvs({charts, {&placement, 1}, {&page, 1}}, charts.triangle_uv, {.baked = true}, {});
    EXPECT_NEAR(made.uvs[2].x, 60.0 / 64, 1.1 / 64);  // at most one texel off
    EXPECT_EQ(made.placements[0].offset, placement.offset);
    return made.thin_triangles;
  };
  EXPECT_EQ(thin(), 0u);
  std::swap(mesh.corners[4], mesh.corners[5]);
  EXPECT_EQ(thin(), 1u);
}

// Returns how far corners of slivers that lean on each other move along an axis, as a share of the
// page, beyond the move of their chart, when they are finished on a page of this size.
double farthest_move(Extent page, const FinishOptions& options) {
  const FlatMesh mesh = leaning_slivers();
  const ChartSet charts = charts_of(mesh);
  ChartPlacement placement;
  placement.page = 0;
  placement.texels_per_unit = {double(page.width), double(page.height)};
  turn_in_box(placement, false);
  const FinishedUvs made =
      finish_uvs({charts, {&placement, 1}, {&page, 1}}, charts.triangle_uv, options, {});
  double most = 0;
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    const Vec2d texel = page_texel(made.placements[0], mesh.uvs[i]);
    most = std::max({most, std::fabs(made.uvs[i].x - texel.x / page.width),
                     std::fabs(made.uvs[i].y - texel.y / page.height)});
  }
  return most;
}

// Pages without images have no light that could be missed.
TEST(FinishUvs, OnlyWhereLightIsBakedUvsStayWithinATexel) {
  constexpr std::int32_t kLong = 16384;
  const double texel = 1.0 / kLong, rounding = 0x1p-24;
  for (const Extent page : {Extent{kLong, 64}, Extent{64, kLong}}) {
    EXPECT_LE(farthest_move(page, {.baked = true}), texel + rounding);
    EXPECT_LE(farthest_move(page, {.mip_levels = 1, .padding = 1}), texel + rounding);
    EXPECT_GT(farthest_move(page, {}), 1.5 * texel) << "the test is too easy";
  }
}

}  // namespace
}  // namespace atlas::test
