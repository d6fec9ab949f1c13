// Tests of mending single triangles that are squeezed to almost nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libatlas/param/descent/arap_solver.h"
#include "libatlas/param/descent/judge.h"
#include "libatlas/param/descent/mend.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

constexpr std::uint32_t kPlateSide = 80;

std::uint32_t at(std::uint32_t x, std::uint32_t y) {
  return y * (kPlateSide + 1) + x;
}

// A flat plate with flat uvs. The vertex (x, y) has moved almost to its neighbour, so that the
// triangles between both have a twentieth of their width.
struct SqueezedPlate {
  Disc disc = testing::make_grid(kPlateSide, kPlateSide, [](double u, double v) {
    return Vec3d{u, v, 0};
  });
  std::vector<Vec2d> uvs;

  SqueezedPlate(std::uint32_t x, std::uint32_t y) {
    uvs = testing::drop_z(disc);
    uvs[at(x, y)].x += 0.95 / kPlateSide;
  }
};

ParamResult judged(const SqueezedPlate& plate, const ParamOptions& options) {
  ParamResult r;
  r.uvs = plate.uvs;
  param::judge(plate.disc.view(), options, r);
  return r;
}

ParamResult mended(const SqueezedPlate& plate, const ParamOptions& options) {
  ParamResult r = judged(plate, options);
  ParamWorkspace workspace;
  const LocalMesh mesh = plate.disc.view();
  param::ArapSolver solver(mesh, {}, workspace.impl());
  param::mend_ruined(mesh, options, solver, r);
  return r;
}

TEST(Mend, GivesSqueezedTrianglesTheirShape) {
  for (const std::uint32_t x : {0u, 3u, 40u}) {  // on the border, near it, and inside
    const SqueezedPlate plate(x, 40);
    const ParamResult before = judged(plate, {}), after = mended(plate, {});
    ASSERT_TRUE(before.within_bound && before.injective);
    ASSERT_GT(before.distortion.stretch_linf, 19);
    EXPECT_TRUE(after.within_bound && after.injective);
    EXPECT_TRUE(check_injectivity(plate.disc.view(), after.uvs).injective);
    const Distortion measured = measure_distortion(plate.disc.view(), after.uvs);
    EXPECT_LT(measured.stretch_linf, 1.25) << x;
    EXPECT_LT(measured.stretch_l2, 1 + 0.01 * (before.distortion.stretch_l2 - 1)) << x;
  }
}

// Both sides of a bound that nothing reaches: it is for the caller to cut there.
TEST(Mend, LeavesWhatIsBeyondTheBound) {
  SqueezedPlate plate(40, 40);
  for (std::uint32_t y = 0; y < kPlateSide; y += 3) plate.uvs[at(40, y)].x += 0.5 / kPlateSide;
  const ParamResult before = judged(plate, {}), after = mended(plate, {});
  ASSERT_FALSE(before.within_bound);
  EXPECT_EQ(after.uvs, before.uvs);
}

TEST(Mend, SmoothingKeepsTheBorderIfAsked) {
  const SqueezedPlate plate(1, 40);
  const LocalMesh mesh = plate.disc.view();
  const std::vector<std::uint32_t> triangles{2 * (40 * kPlateSide + 1)};
  for (const bool border_moves : {false, true}) {
    std::vector<Vec2d> uvs = plate.uvs;
    ParamWorkspace workspace;
    param::ArapSolver solver(mesh, {}, workspace.impl());
    solver.smooth(triangles, border_moves, uvs);
    EXPECT_LT(uvs[at(1, 40)].x, 1.4 / kPlateSide);
    EXPECT_TRUE(check_injectivity(mesh, uvs).injective);
    bool moved = false;
    for (std::uint32_t y = 0; y <= kPlateSide; ++y) moved |= uvs[at(0, y)] != plate.uvs[at(0, y)];
    EXPECT_EQ(moved, border_moves);
  }
}

// Smoothing spreads the distortion of the two squeezed triangles over more of them than a bound
// leaves out.
TEST(Mend, StaysWithinTheBoundHoweverTight) {
  const SqueezedPlate plate(40, 40);
  const double least = judged(plate, {}).distortion.stretch_l2;
  for (const double slack : {1e-6, 1e-3, 3e-3, 1e-2, 3e-2, 0.1}) {
    const ParamOptions options{.max_stretch = least * (1 + slack)};
    const ParamResult before = judged(plate, options), after = mended(plate, options);
    ASSERT_TRUE(before.within_bound) << slack;
    const Distortion measured = measure_distortion(plate.disc.view(), after.uvs);
    EXPECT_LE(std::max(measured.stretch_999, measured.stretch_l2), options.max_stretch) << slack;
    EXPECT_TRUE(check_injectivity(plate.disc.view(), after.uvs).injective) << slack;
  }
}

// A plate with a slit whose banks almost touch. A vertex near one bank has moved towards it.
SqueezedPlate slit_plate() {
  SqueezedPlate plate(39, 70);
  const auto first = static_cast<std::uint32_t>(plate.disc.positions.size());
  for (std::uint32_t y = 41; y <= kPlateSide; ++y) {
    const Vec3d p = plate.disc.positions[at(40, y)];
    plate.disc.positions.push_back(p);
    plate.uvs.push_back({p.x - 0.01 / kPlateSide, p.y});
  }
  for (auto& triangle : plate.disc.triangles) {
    double middle = 0;
    for (const std::uint32_t v : triangle) middle += plate.disc.positions[v].x / 3;
    for (std::uint32_t& v : triangle) {
      if (middle < 0.5 && v % (kPlateSide + 1) == 40 && v >= at(40, 41) && v < first)
        v = first + v / (kPlateSide + 1) - 41;
    }
  }
  return plate;
}

// Smoothing that moves the border would push one bank over the other.
TEST(Mend, BanksThatAlmostTouchDoNotCross) {
  const SqueezedPlate plate = slit_plate();
  const ParamResult before = judged(plate, {}), after = mended(plate, {});
  ASSERT_TRUE(before.within_bound && before.injective);
  ASSERT_GT(before.distortion.stretch_linf, 19);
  EXPECT_TRUE(after.within_bound && after.injective);
  EXPECT_TRUE(check_injectivity(plate.disc.view(), after.uvs).injective);
  EXPECT_LT(measure_distortion(plate.disc.view(), after.uvs).stretch_linf, 4);
}

}  // namespace
}  // namespace atlas
