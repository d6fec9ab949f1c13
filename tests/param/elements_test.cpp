#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "libatlas/param/solvers/stiffness.h"
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
  elements.set_weight(500, 0.25f);
  elements.build(disc.view(), 0);
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

// Also in a large mesh, whose elements are stored in another way.
TEST(Elements, TrianglesWithoutLengthAreRightAngledAndOfTheLeastSize) {
  for (const Disc& plain : {hills(4, 3), hills(260, 200)}) {
    Disc disc = plain;
    const auto corners = disc.triangles[7];
    for (const std::uint32_t v : corners) disc.positions[v] = {1, 2, 3};
    for (const double least : {0.0, 1e-6, 0.01}) {
      param::Elements elements;
      elements.build(disc.view(), least);
      const param::Element e = elements[7];
      EXPECT_EQ(e.foot, 0);
      EXPECT_GT(e.length, 0);
      EXPECT_GT(e.altitude, 0);
      if (least > 0) {
        EXPECT_EQ(e.length, least);
        EXPECT_EQ(e.altitude, least);
      }
      const param::ElementStiffness s = e.stiffness();
      for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(s.own[k] + s.across[k]));
    }
  }
}

// Then there is no size to compare with, and any will do.
TEST(Elements, NothingButPointsHasTrianglesOfSomeSize) {
  Disc disc = hills(4, 3);
  disc.positions.assign(disc.positions.size(), {1, 2, 3});
  param::Elements elements;
  elements.build(disc.view(), 0);
  for (std::size_t t = 0; t < elements.size(); ++t) {
    EXPECT_GT(elements[t].area(), 0);
    const param::ElementStiffness s = elements[t].stiffness();
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(s.own[k] + s.across[k]));
  }
}

TEST(Elements, AFlipIsEveryTriangleThatIsNotPositive) {
  const Disc disc = hills(12, 9);
  param::Elements elements;
  elements.build(disc.view(), 0);
  const auto flips = [&](double x) {  // of the projection, stretched by x
    std::vector<Vec2d> uv;
    for (const Vec3d& p : disc.positions) uv.push_back({x * p.x, std::abs(x) * p.y});
    return param::measure_energy(elements, uv).flips;
  };
  EXPECT_EQ(flips(1), 0u);
  EXPECT_EQ(flips(-1), disc.triangles.size());
  EXPECT_EQ(flips(0), disc.triangles.size());
}

// A map that is a rotation, a stretch along the axes, and another rotation.
TEST(Jacobian, HasTheSingularValuesThatItWasMadeOf) {
  const auto turned = [](glm::dvec2 v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return glm::dvec2(c * v.x - s * v.y, s * v.x + c * v.y);
  };
  for (const double large : {0.5, 1.0, 3.0}) {
    for (const double share : {-1.0, -0.5, -1e-9, 0.0, 1e-9, 0.5, 1.0}) {
      for (const auto& [first, second] : {std::pair{0.0, 0.0}, {0.3, 2.0}, {-2.5, 1.0}}) {
        const double small = share * large;
        const auto map = [&](glm::dvec2 v) {
          v = turned(v, first);
          return turned({large * v.x, small * v.y}, second);
        };
        const param::Jacobian j{map({1, 0}), map({0, 1})};
        const param::SingularValues s = param::singular_values(j);
        EXPECT_NEAR(s.large, large, 1e-12) << share;
        EXPECT_NEAR(s.small, small, 1e-12) << share;
        if (share <= -1) continue;  // every rotation is as near
        const glm::dvec2 r = param::nearest_rotation(j);
        EXPECT_NEAR(r.x, std::cos(first + second), 1e-6) << share;
        EXPECT_NEAR(r.y, std::sin(first + second), 1e-6) << share;
      }
    }
  }
  const param::Jacobian none{{0, 0}, {0, 0}};
  EXPECT_EQ(param::singular_values(none).small, 0);
  EXPECT_EQ(param::nearest_rotation(none), glm::dvec2(1, 0));
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
