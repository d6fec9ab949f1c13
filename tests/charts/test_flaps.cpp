#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "libatlas/charts/flaps.h"
#include "libatlas/charts/part_of_chart.h"
#include "libatlas/param/injectivity.h"
#include "tests/charts/chart_checks.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// A plate of 12 x 12 quads in two flat charts, as if it were rough: those quads (column, row) that
// are `small`, and the rest.
struct Plate {
  explicit Plate(const std::function<bool(int, int)>& small)
      : mesh(grid(12, 12)), topology(*build_topology(mesh.view(), {}, {})) {
    topology.calm_normals = topology.normals;
    FlatChart whole;
    std::vector<std::uint32_t> parts[2];
    for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
      const std::uint32_t* v = &topology.corner_vertex[3 * std::size_t{t}];
      whole.triangles.push_back(t);
      whole.corners.push_back({v[0], v[1], v[2]});
      const bool one = small(int(t / 2 % 12), int(t / 2 / 12));
      partition.chart.push_back(one);
      parts[one].push_back(t);
    }
    for (std::uint32_t v = 0; v < topology.points.size(); ++v) {
      whole.vertex.push_back(v);
      whole.uvs.push_back({topology.points[v].x, topology.points[v].y});
    }
    partition.seams.assign(partition.chart.size(), 0);
    partition.local.resize(partition.chart.size());
    for (const auto& part : parts) charts.push_back(part_of_chart(input, whole, part));
  }

  std::uint32_t border_edges() const {
    LocalChart chart;
    Partition copy = partition;
    chart.build(topology, copy, charts[0].triangles);
    EXPECT_EQ(chart.component_count, 1u);
    EXPECT_EQ(chart.positions.size(), charts[0].uvs.size());
    return chart.border_count;
  }

  Mesh mesh;
  Topology topology;
  ChartOptions options;
  Frames frames;
  FlattenInput input{topology, {}, options, frames};
  Partition partition;
  std::vector<FlatChart> charts;
};

bool corner(int x, int y) {
  return x < 2 && y < 2;
}

// Its sides bulge a little, or it would touch its neighbour all along; it may lie anywhere, and be
// a little smaller.
void move_and_bulge(FlatChart& chart, double stretch) {
  const double half = 0.5 * chart.size.x;
  for (Vec2d& p : chart.uvs) {
    Vec2d d{p.x - half, p.y - half};
    if (std::min(std::abs(d.x), std::abs(d.y)) < 0.1 * half) d = {1.06 * d.x, 1.06 * d.y};
    p = {3 - 0.95 * d.y * stretch, 0.95 * d.x};
  }
}

TEST(Flaps, ASmallChartHangsOnItsNeighbourByOneEdge) {
  Plate plate(corner);
  const std::size_t uvs = plate.charts[0].uvs.size() + plate.charts[1].uvs.size();
  move_and_bulge(plate.charts[1], 1);
  hang_flaps(plate.input, plate.partition, plate.charts, {});
  ASSERT_EQ(plate.charts.size(), 1u);
  const FlatChart& chart = plate.charts[0];
  EXPECT_EQ(chart.triangles.size(), plate.topology.triangle_count());
  EXPECT_TRUE(std::is_sorted(chart.triangles.begin(), chart.triangles.end()));
  EXPECT_EQ(chart.uvs.size(), uvs - 2);
  EXPECT_LT(chart.distortion.stretch_linf, 1.1);
  EXPECT_NEAR(chart.distortion.uv_area, chart.distortion.surface_area, 1e-9);
  // Three edges of what the charts had in common are seams still, of both sides.
  EXPECT_EQ(plate.border_edges(), 48u + 2 * 3);
}

// A flap that fits exactly between others would touch them.
TEST(Flaps, WhereThereIsNoRoomNothingHangs) {
  Plate plate([](int x, int y) { return x > 4 && x < 8 && y > 4 && y < 8; });
  hang_flaps(plate.input, plate.partition, plate.charts, {});
  EXPECT_EQ(plate.charts.size(), 2u);
  for (const std::uint8_t seams : plate.partition.seams) EXPECT_EQ(seams, 0);
}

TEST(Flaps, LargeAndStretchedAndSmoothChartsStayThemselves) {
  {
    Plate halves([](int x, int) { return x < 6; });
    hang_flaps(halves.input, halves.partition, halves.charts, {});
    EXPECT_EQ(halves.charts.size(), 2u);
  }
  {
    Plate stretched(corner);
    stretched.charts[1].distortion.stretch_999 = 2;
    hang_flaps(stretched.input, stretched.partition, stretched.charts, {});
    EXPECT_EQ(stretched.charts.size(), 2u);
  }
  Plate smooth(corner);
  smooth.topology.calm_normals.clear();
  hang_flaps(smooth.input, smooth.partition, smooth.charts, {});
  EXPECT_EQ(smooth.charts.size(), 2u);
}

// What is found to break a limit in the end is taken down again.
TEST(Flaps, WhatBreaksTheBoundIsUndone) {
  Plate plate(corner);
  move_and_bulge(plate.charts[1], 1.6);  // though it claims to be flat
  hang_flaps(plate.input, plate.partition, plate.charts, {});
  ASSERT_EQ(plate.charts.size(), 2u);
  for (const std::uint8_t seams : plate.partition.seams) EXPECT_EQ(seams, 0);
  const auto label = [&](std::uint32_t k) {
    return plate.partition.chart[plate.charts[k].triangles.front()];
  };
  EXPECT_NE(label(0), label(1));
  for (const std::uint32_t k : {0, 1}) {
    for (const std::uint32_t t : plate.charts[k].triangles) {
      EXPECT_EQ(plate.partition.chart[t], label(k));
    }
  }
}

}  // namespace
}  // namespace atlas::test
