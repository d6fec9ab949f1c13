#include "libatlas/uvs/written_stretch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace atlas {
namespace {

// A unit square of two triangles, placed with a turn and a density of 20 by 30 texels a unit.
struct Square {
  std::vector<Vec3f> positions{{5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}};
  std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
  ChartSet charts;
  std::vector<ChartPlacement> placements{1};
  std::vector<Extent> pages{{256, 128}};

  Square() {
    Chart chart;
    chart.triangle_count = 2;
    chart.uv_count = 4;
    charts.charts = {chart};
    charts.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    charts.uv_vertex = {0, 1, 2, 3};
    charts.triangle_uv = indices;
    charts.triangle_chart = {0, 0};
    charts.chart_triangles = {0, 1};
    placements[0].page = 0;
    placements[0].texels_per_unit = {20, 30};
    placements[0].cosine = 0.6;
    placements[0].sine = 0.8;
    placements[0].offset = {60, 7};
  }

  // Measures with uvs `wide` times as wide as the surface.
  WrittenStretch measure(double wide, double max_stretch) const {
    std::vector<Vec2f> uvs;
    for (const Vec2d& uv : charts.uvs) {
      const Vec2d texel = page_texel(placements[0], {wide * uv.x, uv.y});
      uvs.push_back({float(texel.x / 256), float(texel.y / 128)});
    }
    MeshView mesh;
    mesh.positions = positions;
    return measure_written(mesh, {charts, placements, pages}, uvs, max_stretch, {});
  }
};

// At the scale that keeps the area, a map that is a times as wide stretches by the root of a.
TEST(WrittenStretch, IsThatOfTheUvsGiven) {
  const Square square;
  EXPECT_NEAR(square.measure(1, 1.25).stretch_999, 1, 1e-5);
  EXPECT_NEAR(square.measure(1.69, 1.25).stretch_999, 1.3, 1e-5);
  EXPECT_NEAR(square.measure(1 / 1.69, 1.25).stretch_999, 1.3, 1e-5);
}

// Charts that are written 1, 1.1, 1.2, ... times as wide as the surface, in rising and falling
// order. One of them has a single triangle, and a uv far away that belongs to none.
TEST(WrittenStretch, MeasuresEachChartByItself) {
  const Square square;
  constexpr std::uint32_t kCharts = 6;
  for (const bool rising : {false, true}) {
    ChartSet set;
    std::vector<ChartPlacement> placements;
    std::vector<Vec3f> positions;
    std::vector<Vec2f> uvs;
    for (std::uint32_t i = 0; i < kCharts; ++i) {
      Chart chart = square.charts.charts[0];
      chart.first_uv = 4 * i;
      chart.first_triangle = std::uint32_t(set.triangle_chart.size());
      if (i == 2) chart.triangle_count = 1;
      set.charts.push_back(chart);
      const double wide = 1 + 0.1 * (rising ? i : kCharts - 1 - i);
      placements.push_back(square.placements[0]);
      placements.back().chart = i;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const Vec2d uv = square.charts.uvs[k];
        const Vec2d texel = page_texel(square.placements[0], {wide * uv.x, uv.y});
        set.uvs.push_back(uv);
        set.uv_vertex.push_back(4 * i + k);
        positions.push_back(square.positions[k]);
        uvs.push_back({float(texel.x / 256), float(texel.y / 128)});
      }
      if (i == 2) uvs.back() = {0, 1};
      for (std::uint32_t t = 0; t < chart.triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) set.triangle_uv.push_back(4 * i + square.indices[3 * t + k]);
        set.triangle_chart.push_back(i);
        set.chart_triangles.push_back(chart.first_triangle + t);
      }
    }
    MeshView mesh;
    mesh.positions = positions;
    for (double between = 1.05; between < 1.6; between += 0.1) {
      // A chart a times as wide is stretched by the root of a.
      const WrittenStretch written =
          measure_written(mesh, {set, placements, square.pages}, uvs, std::sqrt(between), {});
      EXPECT_NEAR(written.stretch_999, std::sqrt(1.5), 1e-5) << rising;
      EXPECT_EQ(written.beyond, std::uint32_t(std::lround((1.55 - between) * 10))) << between;
    }
  }
}

TEST(WrittenStretch, CountsChartsThatRoundingBringsBeyondTheBound) {
  Square square;
  EXPECT_EQ(square.measure(1, 1.25).beyond, 0u);
  EXPECT_EQ(square.measure(1.252 * 1.252, 1.25).beyond, 0u);  // as little as dense meshes have
  EXPECT_EQ(square.measure(1.26 * 1.26, 1.25).beyond, 1u);
  EXPECT_EQ(square.measure(1.0005 * 1.0005, 1.0001).beyond, 1u);
  square.charts.charts[0].distortion.stretch_999 = 1.3;  // beyond it before, too
  EXPECT_EQ(square.measure(1.26 * 1.26, 1.25).beyond, 0u);
  square.charts.charts[0].distortion.stretch_999 = 1;
  square.charts.charts[0].kept = true;
  EXPECT_EQ(square.measure(1.26 * 1.26, 1.25).beyond, 0u);
}

}  // namespace
}  // namespace atlas
