// What the caller of parameterize() gives is respected: the axis of the projection, the bounds of
// each way, uvs to go on from, and parts that are flat already.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "libatlas/param/parameterize.h"
#include "tests/param/results.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using testing::expect_consistent;
using testing::joined;
using testing::resumed;
using testing::run;
using testing::run_with;

constexpr std::uint32_t kSide = 40;

Disc plate() {
  return testing::make_grid(kSide, kSide, [](double u, double v) { return Vec3d{u, v, 0}; });
}

// The shear of a plate is within the bound, but no solver would leave it.
Vec2d sheared(Vec3d p) {
  return {p.x + 0.2 * p.y, p.y};
}

// Expects a sheared plate, at any scale near 1, except within `near` edges of the middle.
void expect_sheared_far_from_the_middle(const Disc& d, const ParamResult& r, double near) {
  const double scale = r.uvs.back().y / sheared(d.positions.back()).y;
  EXPECT_NEAR(scale, 1, 0.01);
  for (std::size_t v = 0; v < r.uvs.size(); ++v) {
    const Vec3d p = d.positions[v];
    if (std::max(std::abs(p.x - 0.5), std::abs(p.y - 0.5)) * kSide < near) continue;
    ASSERT_NEAR(r.uvs[v].x, scale * sheared(p).x, 1e-12) << v;
    ASSERT_NEAR(r.uvs[v].y, scale * sheared(p).y, 1e-12) << v;
  }
}

// A plane at the angle a to the axis is squeezed by cos a in one direction.
TEST(GivenStarts, TheProjectionHasTheGivenAxis) {
  const double tilt = std::numbers::pi / 6;
  for (const int turn : {0, 1, 2}) {  // each axis of space in turn
    const auto at = [&](double x, double y, double z) {
      const std::array<double, 3> p{x, y, z};
      return Vec3d{p[(3 - turn) % 3], p[(4 - turn) % 3], p[(5 - turn) % 3]};
    };
    const Disc d = testing::make_grid(
        5, 5, [&](double u, double v) { return at(u, v * std::cos(tilt), v * std::sin(tilt)); });
    const ParamOptions along_z{.method = ParamMethod::planar, .axis = at(0, 0, 2)};
    EXPECT_NEAR(run(d, along_z).distortion.conformal_mean, 1 / std::cos(tilt), 1e-6) << turn;
    const ParamOptions along_y{.method = ParamMethod::planar, .axis = at(0, -1, 0)};
    EXPECT_NEAR(run(d, along_y).distortion.conformal_mean, 1 / std::sin(tilt), 1e-6) << turn;
    const ParamOptions mean{.method = ParamMethod::planar};
    EXPECT_NEAR(run(d, mean).distortion.conformal_mean, 1, 1e-6) << turn;
  }
}

TEST(GivenStarts, AProjectionBeyondItsOwnBoundIsNotTaken) {
  const Disc d = testing::make_cylinder(1, 1, 20, 10);
  const double stretch = run(d, {.method = ParamMethod::planar}).distortion.stretch_999;
  ASSERT_GT(stretch, 1.01);
  ASSERT_LT(stretch, 1.25);
  param::FlattenOptions options;
  options.max_planar_stretch = 1 + 1.1 * (stretch - 1);
  EXPECT_TRUE(run_with(d, options).planar);
  options.max_planar_stretch = 1 + 0.9 * (stretch - 1);
  const ParamResult unrolled = run_with(d, options);
  EXPECT_FALSE(unrolled.planar);
  EXPECT_LT(unrolled.distortion.stretch_999, 1.001);
}

TEST(GivenStarts, ResumingMovesOnlyWhatIsAtFault) {
  const Disc d = plate();
  std::vector<Vec2d> start;
  for (const Vec3d& p : d.positions) start.push_back(sheared(p));
  for (const double far : {0.0, 0.7, 1.5}) {  // none; almost at the next vertex; beyond it
    std::vector<Vec2d> uvs = start;
    uvs[kSide / 2 * (kSide + 1) + kSide / 2].x += far / kSide;
    param::FlattenOptions options;
    options.local = true;
    const ParamResult r = resumed(d, uvs, options);
    expect_consistent(d, r, options.max_stretch);
    EXPECT_TRUE(r.injective && r.within_bound) << far;
    expect_sheared_far_from_the_middle(d, r, far > 0 ? 15 : 0);
  }
}

// A sheared plate whose stretch is so small that a descent would make it isometric.
TEST(GivenStarts, ResumingKeepsWhatIsAlmostIsometric) {
  const Disc d = plate();
  std::vector<Vec2d> start;
  for (const Vec3d& p : d.positions) start.push_back({p.x + 0.002 * p.y, p.y});
  const Distortion before = measure_distortion(d.view(), start);
  const ParamResult r = resumed(d, start);
  ASSERT_TRUE(r.injective && r.within_bound);
  EXPECT_NEAR(r.distortion.stretch_999 - 1, before.stretch_999 - 1, 1e-6);
  for (std::size_t v = 0; v < start.size(); ++v) {
    ASSERT_NEAR(r.uvs[v].x, start[v].x, 1e-9) << v;
    ASSERT_NEAR(r.uvs[v].y, start[v].y, 1e-9) << v;
  }
}

// One row of quads has no area, neither on the surface nor in what is given.
TEST(GivenStarts, TrianglesWithoutAreaGetTheLeastAltitude) {
  const double altitude = 1e-4;
  Disc d = plate();
  std::vector<Vec2d> start, corners;
  for (Vec3d& p : d.positions) {
    if (std::abs(p.y - 0.5) < 1e-9) p.y -= 1.0 / kSide;
    start.push_back({p.x, p.y});
  }
  for (const auto& triangle : d.triangles) {
    for (const std::uint32_t v : triangle) corners.push_back(start[v]);
  }
  const param::FlattenOptions options{{.method = ParamMethod::isometric, .min_altitude = altitude}};
  for (const ParamResult& r : {resumed(d, start, options), joined(d, {corners}, options)}) {
    EXPECT_TRUE(r.injective);
    const Injectivity check = check_injectivity(d.view(), r.uvs, {.clearance = 0.3 * altitude});
    EXPECT_TRUE(check.thin.empty()) << check.thin.size();
  }
}

// Nine quads in the middle are flat at another scale than the plate around them.
TEST(GivenStarts, APatchIsFittedInWhereItIs) {
  const Disc d = plate();
  std::vector<Vec2d> corners;
  for (const auto& triangle : d.triangles) {
    double x = 0, y = 0;
    for (const std::uint32_t v : triangle) {
      x += d.positions[v].x / 3 - 0.5 / 3;
      y += d.positions[v].y / 3 - 0.5 / 3;
    }
    const double size = std::max(std::abs(x), std::abs(y)) * kSide < 2 ? 1.1 : 1;
    for (const std::uint32_t v : triangle) {
      const Vec3d p = d.positions[v];
      corners.push_back(sheared({0.5 + size * (p.x - 0.5), 0.5 + size * (p.y - 0.5), 0}));
    }
  }
  param::FlattenOptions options{{.method = ParamMethod::isometric}};
  options.local = true;
  const ParamResult r = joined(d, {.corner_uvs = corners, .patch = true}, options);
  expect_consistent(d, r, options.max_stretch);
  EXPECT_TRUE(r.injective && r.within_bound);
  expect_sheared_far_from_the_middle(d, r, 10);
}

}  // namespace
}  // namespace atlas
