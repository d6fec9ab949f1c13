#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "libatlas/param/stiffness.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

Disc hills(std::uint32_t columns, std::uint32_t rows) {
  return testing::make_grid(columns, rows, [](double u, double v) {
    return Vec3d{2 * u, v, 0.1 * std::sin(9 * u) * std::cos(7 * v)};
  });
}

// The elements of a large mesh are computed from fewer stored values; those of a single triangle
// are stored completely.
TEST(Elements, ALargeMeshHasThoseOfItsTriangles) {
  const Disc disc = hills(260, 200);
  param::Elements elements, one;
  elements.build(disc.view(), 0);
  ASSERT_EQ(elements.size(), 104000u);
  elements.set_weight(500, 0.25f);
  for (std::size_t t = 0; t < elements.size(); t += 100) {
    const std::vector<std::array<std::uint32_t, 3>> triangle = {disc.triangles[t]};
    one.build({disc.positions, triangle}, 0);
    const param::Element wanted = one[0];
    param::Element room;
    const param::Element& got = elements.at(t, room);
    EXPECT_EQ(got.v, wanted.v);
    EXPECT_EQ(got.length, wanted.length);
    EXPECT_EQ(got.foot, wanted.foot);
    EXPECT_EQ(got.altitude, wanted.altitude);
    EXPECT_EQ(got.weight, t == 500 ? 0.25f : 1.0f);
  }
  elements.reset_weights();
  EXPECT_EQ(elements[500].weight, 1.0f);
}

TEST(Elements, WeightsOfASmallMeshReturnToOne) {
  const Disc disc = hills(4, 3);
  param::Elements elements;
  elements.build(disc.view(), 0);
  elements.set_weight(5, 0.5f);
  EXPECT_EQ(elements[5].weight, 0.5f);
  EXPECT_EQ(elements[6].weight, 1.0f);
  elements.reset_weights();
  EXPECT_EQ(elements[5].weight, 1.0f);
}

TEST(PositionView, SinglePrecisionLosesNothingFarAway) {
  const Vec3f origin{1024, -512, 64};
  std::vector<Vec3f> points;
  std::vector<Vec3d> relative;
  for (const Vec3d& p : hills(8, 6).positions) {
    const Vec3f q{float(p.x + origin.x), float(p.y + origin.y), float(p.z + origin.z)};
    points.push_back(q);
    relative.push_back({double(q.x) - origin.x, double(q.y) - origin.y, double(q.z) - origin.z});
  }
  const PositionView view(points, origin);
  ASSERT_EQ(view.size(), relative.size());
  for (std::size_t v = 0; v < relative.size(); ++v) EXPECT_EQ(view[v], relative[v]);
}

}  // namespace
}  // namespace atlas
