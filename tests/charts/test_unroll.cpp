// Surfaces that unroll without stretching: one chart would do, and two are allowed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libatlas/charts/coarse.h"
#include "libatlas/charts/topology.h"
#include "tests/charts/chart_checks.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// `most`: 99.9 % stretch.
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

// With cells of forty triangles.
CoarseMesh coarse_of(const Shape& shape) {
  const Mesh mesh(shape);
  const Result<Topology> topology = build_topology(mesh.view(), {}, {});
  EXPECT_TRUE(topology.ok());
  CellOptions options;
  options.mesh_triangles = 100000;
  Cells cells = grow_cells(*topology, options, {});
  return build_coarse(*topology, 40, cells);
}

// Where a cell unrolls, its flat corners are no farther from each other than along its rim.
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

}  // namespace
}  // namespace atlas::test
