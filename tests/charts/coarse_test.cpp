// The coarse mesh on which merging tries charts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/fan_centre.h"

namespace atlas::test {
namespace {

// Returns a mesh of one cell with the given flat outline and centre.
CoarseMesh one_cell(const std::vector<Vec2d>& outline, Vec2d centre, double area) {
  CoarseMesh mesh;
  CoarseCell cell;
  cell.slot_count = std::uint32_t(outline.size());
  cell.centre = {centre.x, centre.y, 5};
  cell.normal = {0, 0, 1};
  cell.area = area;
  mesh.cells.push_back(cell);
  for (const Vec2d& p : outline) mesh.slot_position.push_back({p.x, p.y, 5});
  return mesh;
}

// Returns the smallest area of a triangle of the fan.
double thinnest(const CoarseMesh& mesh) {
  const Vec3d c = mesh.cells[0].centre;
  double least = 1e9;
  for (std::size_t i = 0; i < mesh.slot_position.size(); ++i) {
    const Vec3d a = mesh.slot_position[i],
                b = mesh.slot_position[(i + 1) % mesh.slot_position.size()];
    least = std::min(least, 0.5 * ((a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x)));
  }
  return least;
}

TEST(FanCentre, MovesToWhereAllOfTheOutlineIsSeen) {
  // An L whose arms are both visible only from the square at its corner; the centroid lies outside
  // it.
  CoarseMesh ell = one_cell({{0, 0}, {10, 0}, {10, 1}, {1, 1}, {1, 10}, {0, 10}}, {2.9, 2.9}, 19);
  ASSERT_LT(thinnest(ell), 0);
  centre_fan(ell, ell.cells[0]);
  EXPECT_GT(thinnest(ell), 0);
  EXPECT_LT(ell.cells[0].centre.x, 1);
  EXPECT_LT(ell.cells[0].centre.y, 1);
  EXPECT_NEAR(ell.cells[0].centre.z, 5, 1e-12);
}

TEST(FanCentre, StaysWhereItIsGoodOrWhereNothingIsBetter) {
  CoarseMesh square = one_cell({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {1.3, 0.8}, 4);
  centre_fan(square, square.cells[0]);
  EXPECT_EQ(square.cells[0].centre, (Vec3d{1.3, 0.8, 5}));
  // A U, in which no point sees both ends.
  CoarseMesh u =
      one_cell({{0, 0}, {3, 0}, {3, 5}, {2, 5}, {2, 1}, {1, 1}, {1, 5}, {0, 5}}, {1.5, 2.1}, 11);
  centre_fan(u, u.cells[0]);
  EXPECT_EQ(u.cells[0].centre, (Vec3d{1.5, 2.1, 5}));
}

}  // namespace
}  // namespace atlas::test
