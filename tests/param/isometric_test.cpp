#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "libatlas/param/cgal_backend.h"
#include "libatlas/param/descent/planar.h"
#include "libatlas/param/distortion.h"
#include "libatlas/param/isometric.h"
#include "tests/param/oracles.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

std::vector<Vec2d> flatten(const Disc& d, const IsometricOptions& options,
                           const IsometricStart& start = {}) {
  ParamWorkspace workspace;
  return flatten_isometric(d.view(), start, options, workspace).uvs;
}
std::vector<Vec2d> flatten(const Disc& d, int iterations, const IsometricStart& start = {}) {
  return flatten(d, {.iterations = iterations}, start);
}

double l2_stretch(const Disc& d, std::span<const Vec2d> uvs) {
  return measure_distortion(d.view(), uvs).stretch_l2;
}

TEST(Isometric, DevelopablesUnrollFromNoStartAtAll) {
  for (const Disc& d : {testing::make_cylinder(5.5, 2, 40, 12), testing::make_cone(0.4, 5, 50, 20),
                        testing::make_cylinder(1, 30, 10, 200)}) {
    const auto uv = flatten(d, 3);
    const Distortion m = measure_distortion(d.view(), uv);
    EXPECT_LT(m.stretch_linf, 1.001);
    EXPECT_EQ(m.flips, 0u);
  }
}

TEST(Isometric, CylinderHasItsLengths) {
  const double arc = 4, height = 2;
  const std::uint32_t columns = 30, rows = 10;
  const Disc d = testing::make_cylinder(arc, height, columns, rows);
  const auto uv = flatten(d, 3);
  // Length of the inscribed polygon.
  const double chord = 2 * std::sin(arc / columns / 2) * columns;
  const Vec2d a = uv[0], b = uv[columns], c = uv[(columns + 1) * rows];
  EXPECT_NEAR(std::hypot(b.x - a.x, b.y - a.y), chord, 1e-9);
  EXPECT_NEAR(std::hypot(c.x - a.x, c.y - a.y), height, 1e-9);
  EXPECT_NEAR((b.x - a.x) * (c.x - a.x) + (b.y - a.y) * (c.y - a.y), 0, 1e-9);
}

TEST(Isometric, EnergyIsTheOneRecomputed) {
  const Disc d = testing::make_cap(1.2, 12);
  ParamWorkspace workspace;
  const IsometricResult result = flatten_isometric(d.view(), {}, {6, 0}, workspace);
  EXPECT_NEAR(result.energy, testing::arap_energy(d.view(), result.uvs), 1e-9);
  EXPECT_GT(result.energy, 1e-3);
}

TEST(Isometric, StepsNeverRaiseTheEnergyAndReachAStationaryPoint) {
  const Disc d = testing::make_grid(14, 9, [](double u, double v) {
    return Vec3d{2 * u, v, 0.3 * std::sin(6 * u) * std::cos(5 * v)};
  });
  for (const double weight : {1.0, 0.6, 0.3}) {
    const IsometricOptions step{.iterations = 1, .shear_weight = weight};
    std::vector<Vec2d> uv = flatten(d, step);
    double before = testing::isometric_energy(d.view(), uv, weight);
    for (int i = 0; i < 200; ++i) {
      uv = flatten(d, step, {.uvs = uv});
      const double now = testing::isometric_energy(d.view(), uv, weight);
      EXPECT_LE(now, before * (1 + 1e-12)) << weight;
      before = now;
    }
    // At a minimum no vertex gains by moving.
    const double far = 1e-4;
    for (const std::size_t v : {std::size_t{0}, uv.size() / 2, uv.size() - 1}) {
      for (const Vec2d move : {Vec2d{far, 0}, Vec2d{-far, 0}, Vec2d{0, far}, Vec2d{0, -far}}) {
        auto moved = uv;
        moved[v] = {uv[v].x + move.x, uv[v].y + move.y};
        EXPECT_GT(testing::isometric_energy(d.view(), moved, weight), before) << weight;
      }
    }
  }
}

// With half the weight of a change of area, shear costs as much as in L2 stretch.
TEST(Isometric, LessWeightOfShearIsLessL2Stretch) {
  for (const double angle : {0.4, 0.8, 1.2}) {
    const Disc d = testing::make_cap(angle, 20);
    const double rigid = l2_stretch(d, flatten(d, {.iterations = 60, .shear_weight = 1})) - 1;
    const double half = l2_stretch(d, flatten(d, {.iterations = 60, .shear_weight = 0.5})) - 1;
    EXPECT_LT(half, 0.92 * rigid) << angle;
    // While stretch is small, this weight is the best of all.
    for (const double weight : {0.25, 0.75}) {
      if (angle > 1) continue;
      const auto uv = flatten(d, {.iterations = 60, .shear_weight = weight});
      EXPECT_LT(half, l2_stretch(d, uv) - 1) << angle << ' ' << weight;
    }
    // A few steps with the defaults come near that.
    EXPECT_LT(l2_stretch(d, flatten(d, 3)) - 1, 1.1 * half) << angle;
  }
}

// Every other step goes beyond the minimum that it is given, from which the next one gains.
TEST(Isometric, RelaxedStepsEndBelowAsManyPlainOnes) {
  for (const std::uint32_t rings : {8u, 40u, 60u}) {  // each uses another solver
    const Disc d = testing::make_cap(1.3, rings);
    const auto energy = [&](std::span<const Vec2d> uvs) {
      return testing::isometric_energy(d.view(), uvs, IsometricOptions{}.shear_weight);
    };
    std::vector<Vec2d> plain = flatten(d, 1);
    const double start = energy(plain);
    for (int i = 1; i < 5; ++i) plain = flatten(d, 1, {.uvs = plain});
    const double end = energy(plain), relaxed = energy(flatten(d, 5));
    EXPECT_LT(end, start);
    EXPECT_LT(relaxed, end) << rings;
  }
}

TEST(Isometric, FramesAndUvsStartAlike) {
  const Disc d = testing::make_cap(1, 15);
  std::vector<Vec2d> uv(d.positions.size());
  project_planar(d.view(), {0, 0, 1}, uv);
  const Vec3d u{uv[1].x / std::sin(1. / 15), uv[1].y / std::sin(1. / 15),
                0};  // vertex 1 lies along +x
  const auto c = static_cast<float>(u.x), s = static_cast<float>(u.y);
  const std::vector<std::array<Vec3f, 2>> frames(d.triangles.size(),
                                                 {Vec3f{c, -s, 0}, Vec3f{s, c, 0}});
  const IsometricOptions options{.iterations = 4, .shear_weight = 1};  // frames contain no shear
  const double from_uvs = testing::arap_energy(d.view(), flatten(d, options, {.uvs = uv}));
  const double from_frames = testing::arap_energy(
      d.view(), flatten(d, options, {.frames = [&](std::size_t t) { return frames[t]; }}));
  EXPECT_NEAR(from_frames, from_uvs, 1e-9);
}

// The solver depends on the size of the disc. All solvers must agree.
TEST(Isometric, SolversAgreeAcrossTheirLimits) {
  for (const std::uint32_t n : {8u, 30u, 45u, 90u, 180u}) {
    const Disc d = testing::make_cylinder(2.5, 1.5, n, n);
    const Distortion m = measure_distortion(d.view(), flatten(d, 2));
    EXPECT_LT(m.stretch_linf, 1 + 1e-4) << n;
    EXPECT_EQ(m.flips, 0u);
  }
}

// Needles from one end of a cylinder to the other, which is jagged. An iteration is slow there, and
// the solver falls back on another one.
TEST(Isometric, LargeMeshesOfNeedlesUnroll) {
  const std::uint32_t n = 4000;
  Disc d = testing::make_cylinder(3, 4, n, 1);
  for (std::uint32_t i = 0; i <= n; i += 40) d.positions[i].z -= 0.5 * (i % 3);
  const auto uv = flatten(d, 3);
  const Distortion m = measure_distortion(d.view(), uv);
  EXPECT_LT(m.stretch_linf, 1.001);
  EXPECT_EQ(m.flips, 0u);
  std::vector<Vec2d> sheared;
  for (const Vec2d p : uv) sheared.push_back({p.x + 0.3 * p.y, p.y});
  const double weight = IsometricOptions{}.shear_weight;
  const auto step = flatten(d, 1, {.uvs = sheared});
  EXPECT_LT(testing::isometric_energy(d.view(), step, weight),
            0.5 * testing::isometric_energy(d.view(), sheared, weight));
}

TEST(Isometric, WorkspaceLeavesNoTrace) {
  const Disc small = testing::make_cap(1, 4), large = testing::make_cap(1.3, 40);
  ParamWorkspace shared;
  for (int i = 0; i < 3; ++i) {
    for (const Disc* d : {&small, &large}) {
      EXPECT_EQ(flatten_isometric(d->view(), {}, {4, 0}, shared).uvs, flatten(*d, 4));
    }
  }
}

TEST(Isometric, PowersOfTwoChangeNoDigit) {
  const Disc d = testing::make_cap(1.1, 20);
  const auto uv = flatten(d, 4);
  for (const int exponent : {-40, -3, 5, 40}) {
    Disc scaled = d;
    const double factor = std::ldexp(1.0, exponent);
    testing::transform(scaled, factor);
    const auto other = flatten(scaled, 4);
    for (std::size_t v = 0; v < uv.size(); ++v) {
      EXPECT_EQ(other[v].x, uv[v].x * factor);
      EXPECT_EQ(other[v].y, uv[v].y * factor);
    }
  }
}

TEST(Isometric, EnergyIsNotAboveCgals) {
  if (!testing::cgal_parameterizers_built())
    GTEST_SKIP() << "CGAL's parameterisation package is not here";
  for (unsigned seed = 0; seed < 6; seed += 2) {
    Disc d = testing::make_cap(0.5 + 0.15 * seed, 14);
    testing::add_radial_noise(d, 0.1 * testing::mean_edge(d), seed);
    const std::vector<Vec2d> theirs = testing::cgal_arap(d.view(), 50);
    ASSERT_EQ(theirs.size(), d.positions.size());
    const auto rigid = flatten(d, {.iterations = 50, .shear_weight = 1});
    EXPECT_LE(testing::arap_energy(d.view(), rigid),
              testing::arap_energy(d.view(), theirs) * (1 + 1e-6))
        << seed;
    EXPECT_LT(l2_stretch(d, flatten(d, 50)), l2_stretch(d, theirs)) << seed;
  }
}

TEST(CgalBackend, FlattensOrSaysThatItIsNotBuilt) {
  const Disc d = testing::make_cap(0.8, 8);
  for (const CgalMethod method : {CgalMethod::arap, CgalMethod::lscm}) {
    std::vector<Vec2d> uv(d.positions.size());
    const Status status = cgal_parameterize(d.view(), method, uv);
    if (!cgal_backend_built()) {
      EXPECT_EQ(status.code(), ErrorCode::unsupported);
      continue;
    }
    ASSERT_TRUE(status.ok()) << status.message();
    const Distortion m = measure_distortion(d.view(), uv);
    EXPECT_NEAR(m.uv_area, m.surface_area, 1e-9);
    EXPECT_LT(m.stretch_999, 1.3);
  }
}

}  // namespace
}  // namespace atlas
