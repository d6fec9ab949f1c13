// Surfaces that unroll except for a few points, such as closed cones and boxes.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libatlas/charts/cells/tips.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/coarse_shapes.h"

namespace atlas::test {
namespace {

// The cone without its base.
Shape open_cone(int around, int along, double half_angle) {
  Shape shape{"closed cone", {{0, 0, 0}}, {}};
  const auto at = [&](int ring, int i) {
    return std::uint32_t(1 + (ring - 1) * around + i % around);
  };
  for (int j = 1; j <= along; ++j) {
    for (int i = 0; i < around; ++i) {
      const double a = 2 * M_PI * i / around, s = double(j) / along, r = s * std::sin(half_angle);
      shape.positions.push_back(
          {float(r * std::cos(a)), float(r * std::sin(a)), float(-s * std::cos(half_angle))});
    }
  }
  for (int i = 0; i < around; ++i) {
    for (const std::uint32_t v : {0u, at(1, i), at(1, i + 1)}) shape.indices.push_back(v);
    for (int j = 1; j < along; ++j) {
      for (const std::uint32_t v :
           {at(j, i), at(j + 1, i), at(j + 1, i + 1), at(j, i), at(j + 1, i + 1), at(j, i + 1)}) {
        shape.indices.push_back(v);
      }
    }
  }
  return shape;
}

TEST(Tips, OfAConeIsItsApex) {
  for (const double half_angle : {0.2, 0.9, 1.4}) {
    const Topology topology = topology_of(open_cone(40, 10, half_angle));
    const std::vector<std::uint32_t> tips = find_tips(topology);
    ASSERT_EQ(tips.size(), 1u) << half_angle;
    EXPECT_EQ(topology.source_vertex[topology.corner_vertex[tips[0]]], 0u);
    // Around the tip are forty flat triangles, whose angles there follow from the law of cosines.
    const double s = 0.1, chord = 2 * s * std::sin(half_angle) * std::sin(M_PI / 40);
    const double around = 40 * 2 * std::asin(0.5 * chord / s);
    EXPECT_NEAR(std::remainder(angle_defect(topology, tips[0]) + around, 2 * M_PI), 0, 1e-4)
        << half_angle;
  }
}

TEST(Tips, OfABoxAreItsCorners) {
  const Topology topology = topology_of(box(12, {3, 2, 0.5}));
  const std::vector<std::uint32_t> tips = find_tips(topology);
  EXPECT_EQ(tips.size(), 8u);
  for (const std::uint32_t h : tips) EXPECT_NEAR(angle_defect(topology, h), M_PI / 2, 1e-4);
}

TEST(Tips, AreNotFoundWhereAllIsCurvedNorWhereNothingIs) {
  for (const Shape& shape : {geodesic_sphere(10), torus(48, 24), noisy(grid(20, 20), 0.01, 3),
                             cylinder(60, 20), grid(9, 9)}) {
    EXPECT_TRUE(find_tips(topology_of(shape)).empty()) << shape.name;
  }
}

TEST(Tips, LieOnTheBordersOfCells) {
  const Topology topology = topology_of(open_cone(40, 10, 0.9));
  const std::vector<std::uint32_t> tips = find_tips(topology);
  Cells cells{std::vector<std::uint32_t>(topology.triangle_count(), 0), 1};
  divide_at_tips(topology, tips, cells);
  EXPECT_EQ(cells.count, 2u);
  std::set<std::uint32_t> around;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    ASSERT_LT(cells.of_triangle[t], 2u);
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (topology.source_vertex[topology.corner_vertex[h]] == 0) {
        around.insert(cells.of_triangle[t]);
      }
    }
  }
  EXPECT_EQ(around.size(), 2u);
}

// A cone of one row is a fan of needles, and each of its cells has only a few of them.
TEST(Tips, ClosedConesTakeFewCharts) {
  for (const int around : {24, 40, 200}) {
    for (const int rows : {1, 12}) {
      for (const double half_angle : {0.2, 0.5, 1.0, 1.4}) {
        const Mesh mesh(open_cone(around, rows, half_angle));
        const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
        ASSERT_TRUE(set.ok());
        EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
        EXPECT_LE(set->charts.size(), 3u) << around << " x " << rows << ", " << half_angle;
      }
    }
  }
}

// Halves of a box meet along all of their border, which has tips on it. They are joined along its
// longest run between these, as the net of a box is.
TEST(Tips, BoxesUnrollIntoNets) {
  for (const int n : {12, 30}) {
    for (const auto& [size, most] : {std::pair(Vec3d{1, 1, 1}, 2u),
                                     {Vec3d{6, 4, 3}, 2u},
                                     {Vec3d{5, 4, 1}, 1u},
                                     {Vec3d{3, 2, 0.5}, 1u}}) {
      const Mesh mesh(box(n, size));
      const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
      ASSERT_TRUE(set.ok());
      EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
      EXPECT_LE(set->charts.size(), most) << n << ": " << size.x << " x " << size.y;
    }
  }
}

}  // namespace
}  // namespace atlas::test
