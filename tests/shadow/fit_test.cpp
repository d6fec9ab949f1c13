#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "libatlas/shadow/fit.h"
#include "tests/shadow/directions.h"

namespace atlas {
namespace {

using test::random_direction;

TEST(Fit, EveryPointOfTheSceneIsInTheMapForEveryLight) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> in(0, 1);
  const Box3 boxes[] = {{{-1, -2, -3}, {4, 5, 6}},
                        {{1e6, 0, 0}, {1e6 + 1, 1, 1}},
                        {{0, 0, 0}, {1e-5, 2e-5, 0}},
                        {{0, 0, 0}, {100, 0, 100}}};
  for (const Box3& box : boxes)
    for (int i = 0; i < 200; ++i) {
      const Vec3d light = i == 0 ? Vec3d{0, 1, 0} : random_direction(rng);
      LightFitOptions o;
      o.resolution = 512;
      const Result<LightFit> fit = fit_light(light, box, o);
      ASSERT_TRUE(fit.ok());
      const double border = o.border_texels / o.resolution * 0.99;
      for (int p = 0; p < 20; ++p) {
        const Vec3d q{box.low.x + in(rng) * (box.high.x - box.low.x),
                      box.low.y + in(rng) * (box.high.y - box.low.y),
                      box.low.z + in(rng) * (box.high.z - box.low.z)};
        const Vec3d m = transform_point(fit->to_texture, q);
        EXPECT_TRUE(m.x >= border && m.x <= 1 - border && m.y >= border && m.y <= 1 - border);
        EXPECT_TRUE(m.z >= 0 && m.z <= 1) << m.z;
        const Vec3d c = transform_point(fit->to_clip, q);
        EXPECT_NEAR(c.x, 2 * m.x - 1, 1e-6);
        EXPECT_NEAR(c.z, 2 * m.z - 1, 1e-6);
      }
    }
}

TEST(Fit, ItIsASimilarityWithTheStatedTexelAndDepth) {
  std::mt19937 rng(8);
  const Box3 box{{0, 0, 0}, {3, 2, 7}};
  for (int i = 0; i < 100; ++i) {
    LightFitOptions o;
    o.up = random_direction(rng);
    const LightFit fit = *fit_light(random_direction(rng), box, o);
    // A step of one unit towards the light changes the depth by 1/range and nothing else.
    const Vec3d along = transform_vector(fit.to_texture, fit.direction);
    EXPECT_NEAR(along.x, 0, 1e-12);
    EXPECT_NEAR(along.y, 0, 1e-12);
    EXPECT_NEAR(along.z * fit.depth_range, -1, 1e-9);
    // Every step has the length that texel size and depth range imply.
    const Vec3d v = random_direction(rng), m = transform_vector(fit.to_texture, v);
    const double scale = fit.texel * o.resolution;
    EXPECT_NEAR(std::hypot(m.x * scale, m.y * scale, m.z * fit.depth_range),
                std::hypot(v.x, v.y, v.z), 1e-9);
    // The map is no larger than the sphere around the box and the border.
    EXPECT_NEAR(fit.texel * (o.resolution - 2 * o.border_texels), std::hypot(3, 2, 7), 1e-9);
  }
}

TEST(Fit, PointsMayBeRelativeToAnOrigin) {
  std::mt19937 rng(10);
  for (int i = 0; i < 20; ++i) {
    LightFitOptions o;
    o.up = random_direction(rng);
    const LightFit fit = *fit_light(random_direction(rng), {{0, 0, 0}, {3, 2, 7}}, o);
    const Vec3d origin = random_direction(rng), p = random_direction(rng);
    const Vec3d want = transform_point(fit.to_clip, p);
    const Vec3d got = transform_point(relative_to(fit.to_clip, origin),
                                      {p.x - origin.x, p.y - origin.y, p.z - origin.z});
    EXPECT_NEAR(got.x, want.x, 1e-12);
    EXPECT_NEAR(got.y, want.y, 1e-12);
    EXPECT_NEAR(got.z, want.z, 1e-12);
  }
}

TEST(Fit, ATurningLightKeepsItsTexelSize) {
  const Box3 box{{0, 0, 0}, {3, 2, 7}};
  const double texel = fit_light({1, 1, 0}, box, {})->texel;
  for (double a = 0; a < 6; a += 0.1)
    EXPECT_DOUBLE_EQ(fit_light({std::cos(a), 1, std::sin(a)}, box, {})->texel, texel);
}

// Returns options for a view of 8 x 6 x 10 around a point.
LightFitOptions view_around(const Vec3d& at) {
  LightFitOptions options;
  options.view = true;
  for (int c = 0; c < 8; ++c)
    options.view_corners[c] = {at.x + (c & 1 ? 4 : -4), at.y + (c & 2 ? 3 : -3),
                               at.z + (c & 4 ? 5 : -5)};
  return options;
}

TEST(Fit, AMovingCameraMovesTheMapByWholeTexels) {
  const Box3 box{{-50, 0, -50}, {50, 10, 50}};
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> in(-20, 20);
  const Vec3d point{1.234, 0.5, -2.345};
  double first_x = 0, first_y = 0, texel = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3d at{in(rng), 1, in(rng)};
    const LightFitOptions o = view_around(at);
    const LightFit fit = *fit_light({0.3, 1, 0.4}, box, o);
    const Vec3d m = transform_point(fit.to_texture, point);
    const double x = m.x * o.resolution, y = m.y * o.resolution;
    if (i == 0) {
      first_x = x;
      first_y = y;
      texel = fit.texel;
    }
    EXPECT_DOUBLE_EQ(fit.texel, texel);
    EXPECT_NEAR(x - first_x, std::round(x - first_x), 1e-6);
    EXPECT_NEAR(y - first_y, std::round(y - first_y), 1e-6);
    for (const Vec3d& corner : o.view_corners) {
      const Vec3d v = transform_point(fit.to_texture, corner);
      EXPECT_TRUE(v.x > 0 && v.x < 1 && v.y > 0 && v.y < 1);
    }
    // The depth of a caster anywhere in the scene stays in range, even if the caster lies beside
    // the map.
    for (double y1 : {0.0, 10.0}) {
      const Vec3d v = transform_point(fit.to_texture, {-50, y1, 50});
      EXPECT_TRUE(v.z >= 0 && v.z <= 1);
    }
  }
}

// Snapping moves a map by at most half a texel from the middle of its view.
TEST(Fit, ASnappedMapIsWithinHalfATexelOfItsView) {
  const Box3 box{{-50, 0, -50}, {50, 10, 50}};
  std::mt19937 rng(10);
  std::uniform_real_distribution<double> in(-20, 20);
  double farthest = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3d at{in(rng), 1, in(rng)};
    const LightFitOptions o = view_around(at);
    const Vec3d m = transform_point(fit_light(random_direction(rng), box, o)->to_texture, at);
    for (const double part : {m.x, m.y}) {
      const double off = std::abs(part - 0.5) * o.resolution;
      EXPECT_LE(off, 0.5 + 1e-6);
      farthest = std::max(farthest, off);
    }
  }
  EXPECT_GT(farthest, 0.45);  // it does snap
}

// Zooming changes the map's size in few steps of less than a tenth each, and the map is never too
// small.
TEST(Fit, AZoomingCameraChangesTheTexelInSmallSteps) {
  const Box3 box{{-500, 0, -500}, {500, 10, 500}};
  std::set<double> sizes;
  for (double reach = 1; reach < 64; reach *= 1.003) {
    LightFitOptions o;
    o.view = true;
    for (int c = 0; c < 8; ++c)
      o.view_corners[c] = {c & 1 ? reach : -reach, c & 2 ? reach : -reach, c & 4 ? reach : -reach};
    const double snapped = fit_light({0.3, 1, 0.4}, box, o)->texel;
    o.snap = false;
    const double needed = fit_light({0.3, 1, 0.4}, box, o)->texel;
    EXPECT_GE(snapped, needed * (1 - 1e-12));
    EXPECT_LE(snapped, needed * 1.0906);
    sizes.insert(snapped);
  }
  EXPECT_LE(sizes.size(), 6 * 8 + 1u);  // six octaves of eight steps each
  EXPECT_GE(sizes.size(), 6 * 8 - 1u);
}

// The view shows a part of the scene. Casters that lie beside the view but towards the light must
// still have depths in range.
TEST(Fit, ASmallViewKeepsTheDepthOfTheWholeScene) {
  const Box3 box{{-50, 0, -50}, {50, 80, 50}};
  LightFitOptions o;
  o.view = true;
  for (int c = 0; c < 8; ++c)
    o.view_corners[c] = {c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : 0.0, c & 4 ? 1.0 : -1.0};
  for (const Vec3d& light : {Vec3d{0, 1, 0}, Vec3d{1, 1, 0}, Vec3d{-0.2, 0.1, 1}}) {
    const LightFit fit = *fit_light(light, box, o);
    for (int c = 0; c < 8; ++c) {
      const Vec3d corner{c & 1 ? 50.0 : -50.0, c & 2 ? 80.0 : 0.0, c & 4 ? 50.0 : -50.0};
      const double depth = transform_point(fit.to_texture, corner).z;
      EXPECT_TRUE(depth >= 0 && depth <= 1) << depth;
    }
  }
}

TEST(Fit, AnyVerticalWillDo) {
  for (const Vec3d& up : {Vec3d{0, 0, 0}, Vec3d{std::nan(""), 0, 0}, Vec3d{0, 1, 0}}) {
    LightFitOptions o;
    o.up = up;
    const Result<LightFit> fit = fit_light({0, 1, 0}, {{-1, -1, -1}, {1, 1, 1}}, o);
    ASSERT_TRUE(fit.ok());
    for (const double m : fit->to_clip) EXPECT_TRUE(std::isfinite(m));
  }
}

// Returns the cube of the given reach around a centre, as the corners of a view.
std::array<Vec3d, 8> cube(const Vec3d& at, double reach) {
  std::array<Vec3d, 8> corners;
  for (int c = 0; c < 8; ++c)
    corners[c] = {at.x + (c & 1 ? reach : -reach), at.y + (c & 2 ? reach : -reach),
                  at.z + (c & 4 ? reach : -reach)};
  return corners;
}

Vec3d sum(const Vec3d& a, const Vec3d& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

// Such a view would only waste texels, or have none.
TEST(Fit, AViewThatIsLargerThanTheSceneOrAPointIsNotUsed) {
  std::mt19937 rng(16);
  const Box3 box{{0, 0, 0}, {3, 2, 7}};
  for (int i = 0; i < 20; ++i) {
    const Vec3d light = random_direction(rng), at = random_direction(rng);
    LightFitOptions o;
    o.snap = false;
    const Matrix4 whole = fit_light(light, box, o)->to_texture;
    o.view = true;
    o.view_corners = cube(at, 0.5);
    EXPECT_NE(fit_light(light, box, o)->to_texture, whole);
    for (const double reach : {0.0, 10.0, 1e200}) {
      o.view_corners = cube(at, reach);
      EXPECT_EQ(fit_light(light, box, o)->to_texture, whole) << reach;
    }
  }
}

// The position of a scene in its world is arbitrary, so the map must look the same everywhere.
TEST(Fit, TheMapMovesWithTheScene) {
  std::mt19937 rng(17);
  const Box3 box{{0, 0, 0}, {30, 20, 70}};
  for (const bool view : {false, true})
    for (int i = 0; i < 50; ++i) {
      const Vec3d light = random_direction(rng), step = random_direction(rng);
      const Vec3d away{1000 * step.x, 1000 * step.y, 1000 * step.z};
      LightFitOptions here;
      here.view = view;
      here.view_corners = cube({10 + step.y, 10 + step.z, 10 + step.x}, 3);
      LightFitOptions there = here;
      for (Vec3d& corner : there.view_corners) corner = sum(corner, away);
      const LightFit a = *fit_light(light, box, here);
      const LightFit b = *fit_light(light, {sum(box.low, away), sum(box.high, away)}, there);
      for (const Vec3d& p : {box.low, box.high, random_direction(rng)}) {
        const Vec3d m = transform_point(a.to_texture, p);
        const Vec3d n = transform_point(b.to_texture, sum(p, away));
        EXPECT_NEAR(m.x, n.x, 1e-9);
        EXPECT_NEAR(m.y, n.y, 1e-9);
        EXPECT_NEAR(m.z, n.z, 1e-9);
      }
    }
}

TEST(Fit, TheSceneIsInTheMiddleOfItsMap) {
  std::mt19937 rng(18);
  for (int i = 0; i < 50; ++i) {
    const Vec3d at = random_direction(rng);
    const Box3 box{{at.x - 3, at.y - 2, at.z - 7}, {at.x + 3, at.y + 2, at.z + 7}};
    const Vec3d m = transform_point(fit_light(random_direction(rng), box, {})->to_texture, at);
    EXPECT_NEAR(m.x, 0.5, 1e-12);
    EXPECT_NEAR(m.y, 0.5, 1e-12);
    EXPECT_NEAR(m.z, 0.5, 1e-12);
  }
}

// A map of a point must be wide enough for the rounding of coordinates of this size.
TEST(Fit, AFarPointIsInTheMiddleOfItsMap) {
  std::mt19937 rng(19);
  for (const double distance : {1.0, 1e6, 1e12, 1e100})
    for (int i = 0; i < 20; ++i) {
      const Vec3d d = random_direction(rng);
      const Vec3d point{distance * d.x, distance * d.y, distance * d.z};
      const Vec3d m =
          transform_point(fit_light(random_direction(rng), {point, point}, {})->to_texture, point);
      EXPECT_NEAR(m.x, 0.5, 1e-4) << distance;
      EXPECT_NEAR(m.y, 0.5, 1e-4) << distance;
      EXPECT_NEAR(m.z, 0.5, 1e-4) << distance;
    }
}

// Renderers hold the matrix in single precision. Corners that face the light are nearest and
// farthest of all points of a box.
TEST(Fit, DepthsStayInRangeInSinglePrecision) {
  std::mt19937 rng(20);
  for (int i = 0; i < 200; ++i) {
    const Vec3d v = random_direction(rng), corner{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
    const Box3 box{{-corner.x, -corner.y, -corner.z}, corner};
    const Matrix4 m = fit_light(corner, box, {})->to_texture;
    for (const Vec3d& p : {box.low, box.high}) {
      const float depth = float(m[2]) * float(p.x) + float(m[6]) * float(p.y) +
                          float(m[10]) * float(p.z) + float(m[14]);
      EXPECT_TRUE(depth >= 0 && depth <= 1) << depth;
    }
  }
}

TEST(Fit, MatricesKeepTheWOfPointsAtOne) {
  const LightFit fit = *fit_light({1, 2, 3}, {{0, 0, 0}, {3, 2, 7}}, {});
  for (const Matrix4& m : {fit.to_texture, fit.to_clip}) {
    for (int column = 0; column < 3; ++column) EXPECT_EQ(m[4 * column + 3], 0) << column;
    EXPECT_EQ(m[15], 1);
  }
}

TEST(Fit, TheLengthOfTheDirectionDoesNotMatter) {
  const Box3 box{{0, 0, 0}, {3, 2, 7}};
  const LightFit want = *fit_light({2, -1, 2}, box, {});
  for (const double length : {5e-324, 1e-200, 1e200, 8e307}) {
    const Result<LightFit> fit = fit_light({2 * length, -length, 2 * length}, box, {});
    ASSERT_TRUE(fit.ok()) << length;
    for (int i = 0; i < 16; ++i) EXPECT_NEAR(fit->to_clip[i], want.to_clip[i], 1e-12) << length;
  }
}

TEST(Fit, BoundsMustBeOrderedFiniteAndNearOnEveryAxis) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const auto made = [](double Vec3d::*axis, double low, double high) {
    Box3 box{{0, 0, 0}, {1, 1, 1}};
    box.low.*axis = low;
    box.high.*axis = high;
    return fit_light({1, 2, 3}, box, {}).ok();
  };
  for (double Vec3d::*axis : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
    EXPECT_TRUE(made(axis, 2, 2));
    EXPECT_TRUE(made(axis, -1e150, 1e150));
    EXPECT_FALSE(made(axis, 1, 0));
    EXPECT_FALSE(made(axis, nan, 1));
    EXPECT_FALSE(made(axis, 0, nan));
    EXPECT_FALSE(made(axis, -infinity, 1));
    EXPECT_FALSE(made(axis, 0, infinity));
    EXPECT_FALSE(made(axis, -1e151, 1));
    EXPECT_FALSE(made(axis, 0, 1e151));
  }
}

TEST(Fit, SaysWhatIsWrong) {
  const Box3 box{{0, 0, 0}, {1, 1, 1}};
  EXPECT_FALSE(fit_light({0, 0, 0}, box, {}).ok());
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (const Vec3d& light : {Vec3d{bad, 1, 1}, Vec3d{0, bad, 0}, Vec3d{1, 1, -bad}})
      EXPECT_FALSE(fit_light(light, box, {}).ok()) << bad;
  EXPECT_FALSE(fit_light({0, 1, 0}, {{1, 0, 0}, {0, 1, 1}}, {}).ok());
  LightFitOptions tiny;
  tiny.resolution = 8;
  EXPECT_FALSE(fit_light({0, 1, 0}, box, tiny).ok());
  for (const int resolution : {0, -1, -2048}) {
    tiny.resolution = resolution;
    EXPECT_FALSE(fit_light({0, 1, 0}, box, tiny).ok()) << resolution;
  }
  EXPECT_TRUE(fit_light({0, 1, 0}, {{5, 5, 5}, {5, 5, 5}}, {}).ok());  // a single point
  EXPECT_FALSE(fit_light({0, 1, 0}, {{-1e200, 0, 0}, {1e200, 1, 1}}, {}).ok());
  LightFitOptions negative, nowhere;
  negative.border_texels = -1;
  EXPECT_FALSE(fit_light({0, 1, 0}, box, negative).ok());
  nowhere.view = true;
  nowhere.view_corners[3].y = std::nan("");
  EXPECT_FALSE(fit_light({0, 1, 0}, box, nowhere).ok());
}

}  // namespace
}  // namespace atlas
