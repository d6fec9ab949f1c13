// Rows of needles, as coarse sweeps along a path have them, and the cells that they bound.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/cells/rows.h"
#include "libatlas/charts/merging/coarse.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/coarse_shapes.h"

namespace atlas::test {
namespace {

// A rounded box of 0.2 x 0.16 with `around` corners, swept over a length of 50 along an arc in some
// steps. Its ends are open.
Shape rail(int around, int steps, double radius) {
  const auto rounded = [](double x) { return std::copysign(std::sqrt(std::abs(x)), x); };
  Shape shape{"rail", {}, {}};
  for (int i = 0; i <= steps; ++i) {
    const double turn = 50.0 * i / (steps * radius);
    for (int j = 0; j < around; ++j) {
      const double angle = 2 * M_PI * j / around;
      const double r = radius + 0.1 * rounded(std::cos(angle));
      shape.positions.push_back({float(r * std::sin(turn)), float(r * std::cos(turn) - radius),
                                 float(0.08 * rounded(std::sin(angle)))});
    }
  }
  const auto at = [&](int i, int j) { return std::uint32_t(i * around + j % around); };
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < around; ++j) {
      shape.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return shape;
}

// A wavy strip of 20 rows of needles, as high as `length` in all, whose rows bend a little.
Shape needle_strip(int across, double length) {
  Shape shape = grid(across, 20, 1, length);
  shape.name = "strip";
  for (Vec3f& p : shape.positions) {
    p.z = float(0.05 * std::sin(20.0 * p.x) + 5e-4 * length * std::sin(100.0 * p.y / length));
  }
  return shape;
}

std::set<std::uint32_t> names(const Regions& rows) {
  return {rows.of_triangle.begin(), rows.of_triangle.end()};
}

TEST(Rows, OfASweepAreItsSteps) {
  const Topology topology = topology_of(rail(60, 12, 50));
  const Regions rows = find_rows(topology, plan_cells(topology, {}));
  EXPECT_EQ(rows.share[0], 1);
  EXPECT_EQ(names(rows).size(), 12u);
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    EXPECT_EQ(rows.of_triangle[t], rows.of_triangle[t - t % 120]);
  }
}

TEST(Rows, AreNotFoundOnCompactTriangles) {
  for (const Shape& shape : {geodesic_sphere(12), torus(72, 36), box(9), cylinder(40, 20, 1, 6)}) {
    const Topology topology = topology_of(shape);
    const Regions rows = find_rows(topology, plan_cells(topology, {}));
    EXPECT_EQ(names(rows), std::set{kNoIndex}) << shape.name;
    EXPECT_EQ(rows.share[0], 0) << shape.name;
  }
}

TEST(Rows, AreNotFoundWhereOneIsAllOrCellsAreFewer) {
  const Topology one = topology_of(cylinder(100, 1, 1, 5));
  EXPECT_EQ(names(find_rows(one, plan_cells(one, {}))), std::set{kNoIndex});
  const Topology twelve = topology_of(rail(60, 12, 50));
  CellPlan plan = plan_cells(twelve, {});
  plan.cells[0] = 11;
  EXPECT_EQ(names(find_rows(twelve, plan)), std::set{kNoIndex});
  plan.cells[0] = 0;  // left out
  EXPECT_EQ(names(find_rows(twelve, plan)), std::set{kNoIndex});
}

TEST(Rows, BoundCellsWhoseFansFit) {
  const Topology topology = topology_of(rail(200, 20, 50));
  const CellPlan plan = plan_cells(topology, {});
  const Regions rows = find_rows(topology, plan);
  const auto mean_error = [&](const Regions* regions) {
    Cells cells = grow_cells({topology, plan, regions}, {}, {});
    std::map<std::uint32_t, std::uint32_t> row_of;
    for (std::uint32_t t = 0; t < topology.triangle_count() && regions; ++t) {
      const std::uint32_t row = rows.of_triangle[t];
      EXPECT_EQ(row_of.try_emplace(cells.of_triangle[t], row).first->second, row);
    }
    const CoarseMesh mesh = build_coarse(topology, 40, cells);
    double error = 0, area = 0;
    for (const CoarseCell& cell : mesh.cells) {
      error += cell.area * fan_error(mesh, cell);
      area += cell.area;
    }
    return error / area;
  };
  EXPECT_GT(mean_error(nullptr), 0.5);
  EXPECT_LT(mean_error(&rows), 0.03);
}

// Came out in 8 to 32 charts, since fans of cells across several steps refused good mergers. With
// the smallest radius each chart bends as far as a cut is worth.
TEST(Rows, BentRailsComeOutInFewCharts) {
  for (const auto& [radius, most] : std::map<double, std::size_t>{{500, 3}, {50, 4}, {10, 15}}) {
    EXPECT_LE(checked_charts(Mesh(rail(200, 20, radius)), 0).charts.size(), most) << radius;
  }
}

// Came out in 18 and 53 charts.
TEST(Rows, StripsOfNeedlesComeOutInFewChartsInAnyUnit) {
  for (const double length : {100, 1000}) {
    for (const double unit : {1.0, 1e-3}) {
      const Shape shape = moved(needle_strip(240, length), unit);
      EXPECT_LE(checked_charts(Mesh(shape), 0).charts.size(), 2u) << length << " x " << unit;
    }
  }
}

}  // namespace
}  // namespace atlas::test
