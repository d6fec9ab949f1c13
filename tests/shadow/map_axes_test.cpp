// The axes of a light's map in the world: which way they point, and what replaces a vertical that
// no map can have.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "libatlas/shadow/fit.h"
#include "tests/shadow/directions.h"

namespace atlas {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<Vec3d, 3> kAxes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

using test::cross;
using test::dot;
using test::kDegree;
using test::scaled;
using test::unit;

// Expects unit axes that form, with the direction towards the light, a right-handed system in which
// `up` lies in the plane of the map's vertical and the light, and points upwards.
void expect_upright(const MapAxes& axes, const Vec3d& light, const Vec3d& up) {
  const Vec3d back = cross(axes.x, axes.y), l = unit(light);
  EXPECT_NEAR(back.x, l.x, 1e-12);
  EXPECT_NEAR(back.y, l.y, 1e-12);
  EXPECT_NEAR(back.z, l.z, 1e-12);
  EXPECT_NEAR(dot(axes.x, axes.x), 1, 1e-12);
  EXPECT_NEAR(dot(axes.y, axes.y), 1, 1e-12);
  EXPECT_NEAR(dot(axes.x, unit(up)), 0, 1e-12);
  EXPECT_GT(dot(axes.y, unit(up)), 0);
}

// A viewer at the light sees the map as it is: y upwards and x to the right.
TEST(MapAxes, TheMapIsUprightSeenFromTheLight) {
  const MapAxes front = map_axes({0, 0, 5}, {0, 2, 0});
  EXPECT_EQ(front.x, (Vec3d{1, 0, 0}));
  EXPECT_EQ(front.y, (Vec3d{0, 1, 0}));
  std::mt19937 rng(11);
  for (int i = 0; i < 200; ++i) {
    const Vec3d light = test::random_direction(rng), up = test::random_direction(rng);
    expect_upright(map_axes(light, up), light, up);
  }
}

TEST(MapAxes, AVerticalOneDegreeFromTheLightIsKept) {
  std::mt19937 rng(12);
  for (const double degrees : {1.0, 2.0, 5.0, 175.0, 179.0})
    for (int i = 0; i < 20; ++i) {
      const Vec3d up = unit(test::random_direction(rng));
      const Vec3d side = unit(cross(up, test::random_direction(rng)));
      const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
      const Vec3d light{c * up.x + s * side.x, c * up.y + s * side.y, c * up.z + s * side.z};
      const MapAxes axes = map_axes(light, up);
      expect_upright(axes, light, up);
      EXPECT_NEAR(dot(axes.y, up), s, 1e-9) << degrees;
    }
}

// Squares of the first and last of these lengths leave the range of doubles.
TEST(MapAxes, TheLengthOfTheVerticalDoesNotMatter) {
  std::mt19937 rng(13);
  for (const double length : {1e-200, 1e-3, 1e3, 1e200})
    for (int i = 0; i < 20; ++i) {
      const Vec3d light = test::random_direction(rng), up = test::random_direction(rng);
      expect_upright(map_axes(light, scaled(up, length)), light, up);
    }
}

// The coordinate axis farthest from the light makes the largest angle with it.
TEST(MapAxes, TheAxisFarthestFromTheLightReplacesAnUnusableVertical) {
  std::mt19937 rng(14);
  for (int i = 0; i < 200; ++i) {
    const Vec3d light = test::random_direction(rng), l = unit(light);
    const Vec3d farthest = *std::ranges::min_element(
        kAxes, {}, [&](const Vec3d& axis) { return std::abs(dot(axis, l)); });
    for (const Vec3d& up :
         {light, scaled(light, -1), scaled(light, 1e-200), scaled(light, 1e200), Vec3d{0, 0, 0},
          Vec3d{kNotANumber, 0, 0}, Vec3d{0, kNotANumber, 1}, Vec3d{0, 1, kInfinity}})
      expect_upright(map_axes(light, up), light, farthest);
  }
}

TEST(MapAxes, AreThoseOfTheFittedMap) {
  std::mt19937 rng(15);
  for (int i = 0; i < 50; ++i) {
    LightFitOptions o;
    o.up = test::random_direction(rng);
    const Vec3d light = test::random_direction(rng);
    const LightFit fit = *fit_light(light, {{0, 0, 0}, {3, 2, 7}}, o);
    const MapAxes axes = map_axes(light, o.up);
    const double side = fit.texel * o.resolution;
    const Vec3d x = transform_vector(fit.to_texture, axes.x);
    const Vec3d y = transform_vector(fit.to_texture, axes.y);
    EXPECT_NEAR(x.x * side, 1, 1e-12);
    EXPECT_NEAR(x.y * side, 0, 1e-12);
    EXPECT_NEAR(y.x * side, 0, 1e-12);
    EXPECT_NEAR(y.y * side, 1, 1e-12);
  }
}

}  // namespace
}  // namespace atlas
