// Surfaces that unroll without stretch. One chart would be enough; two are allowed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/unroll.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/coarse_shapes.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// `most` limits the 99.9 % stretch.
void expect_unrolled(const Shape& shape, double bound, double most, const std::string& name) {
  const Mesh mesh(shape);
  ChartOptions options;
  options.max_stretch = bound;
  const Result<ChartSet> set = make_charts(mesh.view(), options, {});
  ASSERT_TRUE(set.ok()) << name;
  const ChartFindings found = check_charts(mesh.view(), *set);
  EXPECT_EQ(found.fault, "") << name;
  EXPECT_LE(set->charts.size(), 2u) << name << " within " << bound;
  EXPECT_LE(found.stretch_999, most) << name << " within " << bound;
}

TEST(Unroll, ClosedRibbonsOfAnyWidth) {
  for (const int around : {40, 80, 100, 200, 400}) {
    for (const int rows : {1, 4}) {
      for (const double height : {0.003, 0.02, 10.0}) {
        for (const double bound : {1.001, 1.25}) {
          expect_unrolled(cylinder(around, rows, 1, height), bound, 1.0011,
                          fmt::format("{} x {} quads, {} high", around, rows, height));
        }
      }
    }
  }
}

TEST(Unroll, ConesOfAnyAngle) {
  for (const int around : {40, 400}) {
    for (const int rows : {2, 10}) {
      for (const double angle : {0.2, 0.9, 1.4}) {
        expect_unrolled(cone(around, rows, angle), 1.25, 1.005,
                        fmt::format("{} x {} quads, half-angle {}", around, rows, angle));
      }
    }
  }
}

// A needle fills only half of its rectangle, and so do several.
TEST(Unroll, NeedlesAroundATipBecomeSectors) {
  for (const int around : {32, 100, 256}) {
    for (const double height : {0.5, 2.0, 5.0}) {
      const Mesh mesh(closed_cone(around, height));
      const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
      ASSERT_TRUE(set.ok());
      EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
      EXPECT_LE(set->charts.size(), 3u) << around << " around, " << height << " high";
    }
  }
}

// A disc with `corners` corners around it. Its caps are triangulated in zigzag from side to side,
// as CAD programs do. Adjacent triangles are needles whose centroids are far apart.
Shape zigzag_disc(int corners, double radius, double height) {
  Shape shape;
  for (const double z : {0.0, height}) {
    for (int i = 0; i < corners; ++i) {
      const double a = 2 * M_PI * i / corners;
      shape.positions.push_back(
          {float(radius * std::cos(a)), float(radius * std::sin(a)), float(z)});
    }
  }
  const auto add = [&](int a, int b, int c) {
    for (const int i : {a, b, c}) shape.indices.push_back(std::uint32_t(i));
  };
  int low = 0, high = corners - 1;
  for (bool up = false; high - low > 1; up = !up) {
    const int next = up ? high - 1 : low + 1;
    add(corners + low, corners + next, corners + high);
    add(low, high, next);
    (up ? high : low) = next;
  }
  for (int i = 0; i < corners; ++i) {
    const int k = (i + 1) % corners;
    add(i, k, corners + k);
    add(i, corners + k, corners + i);
  }
  return shape;
}

TEST(Unroll, CapsOfNeedlesEndAtTheirCreases) {
  for (const int corners : {600, 2000}) {
    for (const double height : {1.0, 3.0}) {
      const Mesh mesh(zigzag_disc(corners, 10, height));
      const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
      ASSERT_TRUE(set.ok());
      EXPECT_LE(set->charts.size(), 4u) << corners << " corners, " << height << " high";
    }
  }
}

// If a cell unrolls, its flat corners are no farther from each other than along its rim.
TEST(Unroll, CellsOfACylinderAndOfASphere) {
  const CoarseMesh tube = coarse_of(cylinder(200, 100));
  ASSERT_GT(tube.cells.size(), 100u);
  for (const CoarseCell& cell : tube.cells) {
    ASSERT_TRUE(cell.unrolls);
    double twice = 0, rim = 0, flat = 0;
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      const Vec2d a = tube.flat_slot[s], b = tube.flat_slot[tube.next_slot(s, cell)];
      twice += a.x * b.y - a.y * b.x;
      flat += std::hypot(b.x - a.x, b.y - a.y);
      rim += tube.arcs[tube.slot_arc[s]].length;
    }
    EXPECT_GT(twice, 0);
    EXPECT_LE(flat, rim * (1 + 1e-6));
    EXPECT_GE(flat, 0.6 * rim);  // rims are zigzags of edges
  }
  for (const CoarseCell& cell : coarse_of(sphere(300, 150)).cells) EXPECT_FALSE(cell.unrolls);
}

// A sheet of three parts side by side: bent, plane, and slightly rough. Two cells cover the bent
// part, one the plane part, and the rough one has a cell for each triangle. The vertices that the
// plane and the rough cells share are curved. Two cells touch the plane one, and it is tried once
// all the same.
TEST(Unroll, APlaneCellBesideCurvedVerticesDoesNotBecomeFlatWhenTriedAgain) {
  constexpr int kWide = 60, kHigh = 20, kBent = 20, kRough = 40;
  Shape sheet = grid(kWide, kHigh, kWide, kHigh);
  std::vector<int> column;
  for (Vec3f& p : sheet.positions) {
    column.push_back(static_cast<int>(std::lround(p.x)));
    if (column.back() < kBent) {
      const double angle = double(kBent - column.back()) / kBent;
      p.x = static_cast<float>(kBent - kBent * std::sin(angle));
      p.z = static_cast<float>(kBent - kBent * std::cos(angle));
    } else if (column.back() > kRough) {
      p.z = static_cast<float>(0.015 * std::sin(12.9898 * p.x + 78.233 * p.y));
    }
  }
  const Topology topology = topology_of(sheet);
  Cells cells;
  cells.count = 3;
  for (std::uint32_t t = 0; t < sheet.triangle_count(); ++t) {
    const std::uint32_t* v = &sheet.indices[3 * std::size_t{t}];
    const int left = std::min({column[v[0]], column[v[1]], column[v[2]]});
    const bool upper = sheet.positions[v[0]].y + sheet.positions[v[1]].y > kHigh;
    cells.of_triangle.push_back(left >= kRough  ? cells.count++
                                : left >= kBent ? 2
                                                : std::uint32_t(upper));
  }
  const CoarseMesh mesh = build_coarse(topology, 40, cells);
  EXPECT_TRUE(mesh.cells[0].unrolls && mesh.cells[1].unrolls);
  EXPECT_FALSE(mesh.cells[2].unrolls);
}

// Lays the half x > 0 of a shape (or all of it, if `whole`) flat as one chart. Returns its largest
// stretch, or 0 if it does not unroll.
double unrolled_stretch(const Shape& shape, bool whole = false, double min_altitude = 0) {
  const Mesh mesh(shape);
  const Result<Topology> topology = build_topology(mesh.view(), {}, {});
  EXPECT_TRUE(topology.ok());
  Partition partition;
  partition.seams.assign(shape.triangle_count(), 0);
  partition.local.resize(shape.triangle_count());
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < shape.triangle_count(); ++t) {
    const std::uint32_t* v = &shape.indices[3 * std::size_t{t}];
    const double x = shape.positions[v[0]].x + shape.positions[v[1]].x + shape.positions[v[2]].x;
    partition.chart.push_back(whole || x > 0 ? 0 : 1);
    if (partition.chart[t] == 0) triangles.push_back(t);
  }
  LocalChart chart;
  chart.build(*topology, partition, triangles);
  std::vector<Vec2d> uvs;
  if (!unroll_chart(chart, min_altitude, uvs)) return 0;
  const Distortion distortion = measure_distortion(chart.mesh(), uvs);
  EXPECT_EQ(distortion.flips, 0u);
  return distortion.stretch_linf;
}

TEST(Unroll, AChartIsLaidFlatExactly) {
  // Also for triangles that are much higher than wide: errors must not grow from one triangle to
  // the next.
  for (const double height : {0.1, 1.0, 30.0}) {
    const double stretch = unrolled_stretch(cylinder(150, 40, 1, height));
    EXPECT_GE(stretch, 1) << height;
    EXPECT_LE(stretch, 1 + 1e-5) << height;
  }
}

TEST(Unroll, ACurvedChartATubeAndOneOfSliversAreNot) {
  EXPECT_EQ(unrolled_stretch(sphere(60, 30)), 0);
  EXPECT_EQ(unrolled_stretch(cylinder(60, 10), true), 0);  // closed around
  EXPECT_GE(unrolled_stretch(cylinder(60, 10), false, 0.01), 1);
  EXPECT_EQ(unrolled_stretch(cylinder(60, 10), false, 0.3), 0);
}

TEST(Unroll, ChartsThatUnrollAreExact) {
  for (const Shape& shape : {cylinder(100, 30), box(4, {1, 0.7, 0.2}), cone(100, 10, 0.9)}) {
    const Mesh mesh(shape);
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok());
    EXPECT_EQ(check_charts(mesh.view(), *set).fault, "") << shape.name;
    EXPECT_LE(set->distortion.stretch_linf, 1 + 1e-5) << shape.name;
  }
}

}  // namespace
}  // namespace atlas::test
