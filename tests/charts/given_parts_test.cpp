// ChartOptions::keep_uv_charts where one part of the mesh is cut anew and the rest is not touched.
#include <gtest/gtest.h>

#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

// A plate with uvs of its own beside a sphere whose uvs fold over.
TEST(GivenUvs, OnlyTheSurfaceWhoseUvsFoldIsCutAnew) {
  const Shape plate = grid(12, 12, 2, 3), ball = moved(icosphere(3), 1, {9, 0, 0});
  Mesh mesh(together(plate, ball));
  for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({0.1f * p.x, 0.1f * p.y});
  mesh.texcoord_indices = mesh.indices;
  ChartOptions options;
  options.keep_uv_charts = true;
  const Result<ChartSet> set = make_charts(mesh.view(), options, {});
  ASSERT_TRUE(set.ok());
  const ChartFindings found = check_charts(mesh.view(), *set);
  EXPECT_EQ(found.fault, "");
  EXPECT_LE(found.stretch_999, 1.25 * (1 + 1e-6));
  EXPECT_EQ(set->repairs.kept_charts, 1u);
  EXPECT_EQ(set->repairs.reflattened_charts, 1u);
  // There are as many charts as the sphere takes by itself, and one for the plate.
  const Result<ChartSet> alone = make_charts(Mesh(ball).view(), {}, {});
  ASSERT_TRUE(alone.ok());
  EXPECT_LE(set->charts.size(), alone->charts.size() + 1);
  for (const Chart& chart : set->charts) {
    const bool of_plate = set->chart_triangles[chart.first_triangle] < plate.triangle_count();
    EXPECT_EQ(chart.kept, of_plate);
    for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
      const std::uint32_t t = set->chart_triangles[chart.first_triangle + i];
      EXPECT_EQ(t < plate.triangle_count(), of_plate);
    }
  }
}

}  // namespace
}  // namespace atlas::test
