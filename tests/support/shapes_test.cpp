#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atlas::test {
namespace {

TEST(Shapes, TopologyIsWhatTheNameSays) {
  EXPECT_EQ(euler_characteristic(grid(5, 4)), 1);
  EXPECT_EQ(euler_characteristic(box(3)), 2);
  EXPECT_EQ(euler_characteristic(sphere(12, 7)), 2);
  EXPECT_EQ(euler_characteristic(icosphere(2)), 2);
  EXPECT_EQ(euler_characteristic(geodesic_sphere(7)), 2);
  EXPECT_EQ(geodesic_sphere(7).triangle_count(), 20u * 49);
  EXPECT_EQ(euler_characteristic(torus(12, 6)), 0);
  EXPECT_EQ(euler_characteristic(cylinder(12, 3)), 0);
  EXPECT_EQ(euler_characteristic(cone(12, 3, 0.4)), 1);
  EXPECT_EQ(euler_characteristic(cap(12, 3, 0.4)), 1);
  for (int holes : {1, 2, 7})
    EXPECT_EQ(euler_characteristic(plate_with_holes(holes, 2)), 2 - 2 * holes);
  for (const Shape& closed : {box(3), sphere(12, 7), icosphere(2), geodesic_sphere(5), torus(12, 6),
                              plate_with_holes(2, 2)})
    EXPECT_EQ(border_edges(closed), 0u) << closed.name;
}

TEST(Shapes, AreasApproachTheirClosedForms) {
  const double pi = std::numbers::pi;
  EXPECT_NEAR(surface_area(grid(7, 3, 2, 5)), 10, 1e-5);
  EXPECT_NEAR(surface_area(box(4, {1, 2, 3})), 22, 1e-5);
  EXPECT_NEAR(surface_area(icosphere(5)), 4 * pi, 4 * pi * 0.002);
  EXPECT_NEAR(surface_area(geodesic_sphere(32)), 4 * pi, 4 * pi * 0.002);
  EXPECT_NEAR(surface_area(torus(200, 100)), 4 * pi * pi * 0.4, 0.02);
  EXPECT_NEAR(surface_area(cylinder(400, 2)), 4 * pi, 0.01);
  EXPECT_NEAR(surface_area(cone(400, 4, 0.5)), pi * std::sin(0.5), 0.01);
  EXPECT_NEAR(surface_area(cap(200, 100, 0.9)), 2 * pi * (1 - std::cos(0.9)), 0.01);
}

// Six times the signed volume of a closed mesh is positive if its triangles face outwards.
TEST(Shapes, ClosedOnesFaceOutwards) {
  for (const Shape& s : {box(3), sphere(12, 7), icosphere(2), geodesic_sphere(5), torus(12, 6),
                         plate_with_holes(2, 2)}) {
    double volume = 0;
    for (std::size_t t = 0; t < s.indices.size(); t += 3) {
      const Vec3f a = s.positions[s.indices[t]], b = s.positions[s.indices[t + 1]],
                  c = s.positions[s.indices[t + 2]];
      volume += a.x * (double(b.y) * c.z - double(b.z) * c.y) +
                a.y * (double(b.z) * c.x - double(b.x) * c.z) +
                a.z * (double(b.x) * c.y - double(b.y) * c.x);
    }
    EXPECT_GT(volume, 0) << s.name;
  }
}

TEST(Shapes, EveryZooMemberIsUsable) {
  for (const Shape& shape : zoo()) {
    EXPECT_GT(shape.triangle_count(), 0u) << shape.name;
    EXPECT_GT(surface_area(shape), 0) << shape.name;
    for (std::uint32_t v : shape.indices) ASSERT_LT(v, shape.positions.size()) << shape.name;
  }
}

}  // namespace
}  // namespace atlas::test
