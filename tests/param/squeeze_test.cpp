#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "libatlas/param/descent/arap_solver.h"
#include "libatlas/param/parameterize.h"
#include "tests/param/results.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using testing::expect_consistent;
using testing::run;
using testing::run_with;

// Milnor 1969, "A problem in cartography": no map of a cap of half-angle a has a smaller ratio of
// its greatest to its least scale than a / sin a, which the azimuthal equidistant projection
// reaches.
TEST(Squeeze, CapsMeetMilnorsOptimum) {
  for (const double degrees : {20.0, 45.0, 70.0, 90.0}) {
    const double a = degrees * std::numbers::pi / 180, optimum = a / std::sin(a);
    const Disc d = testing::make_cap(a, 40);
    param::FlattenOptions options;
    options.method = ParamMethod::isometric;
    options.iterations = 20;
    options.max_stretch = 1.0001;  // cannot be reached, so all squeeze steps are done
    options.squeeze_iterations = 40;
    options.squeeze_ratio = true;
    const ParamResult r = run_with(d, options);
    std::vector<TriangleStretch> s(d.triangles.size());
    measure_triangles(d.view(), r.uvs, s);
    double greatest = 0, least = 1e300;
    for (const TriangleStretch& t : s) {
      greatest = std::max<double>(greatest, t.s1);
      least = std::min<double>(least, t.s2);
    }
    EXPECT_LT(greatest / least, 1.02 * optimum) << degrees;
    EXPECT_GT(greatest / least, 0.995 * optimum)
        << degrees;  // only the coarseness of the polyhedron makes it lower
    EXPECT_TRUE(r.injective);
  }
}

TEST(Squeeze, ReachesABoundThatDescentMisses) {
  const Disc d = testing::make_grid(50, 50, [](double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    return Vec3d{x, y, 0.9 * std::exp(-6 * (x * x + y * y))};
  });
  ParamOptions plain{.method = ParamMethod::isometric, .iterations = 30, .squeeze_iterations = 0};
  const double reached = run(d, plain).distortion.stretch_999;
  ParamOptions squeezed = plain;
  squeezed.max_stretch = 1 + 0.8 * (reached - 1);
  EXPECT_FALSE(run(d, {.max_stretch = squeezed.max_stretch,
                       .method = ParamMethod::isometric,
                       .iterations = 30,
                       .squeeze_iterations = 0})
                   .within_bound);
  squeezed.squeeze_iterations = 12;
  const ParamResult r = run(d, squeezed);
  expect_consistent(d, r, squeezed.max_stretch);
  EXPECT_TRUE(r.within_bound) << reached << " -> " << r.distortion.stretch_999;
  param::FlattenOptions local{squeezed};
  local.local = true;  // so many triangles stretch that relaxing few places is not possible
  EXPECT_TRUE(run_with(d, local).within_bound);
}

// A strip of flat faces that are folded by right angles, with a small ear between two faces at both
// ends of each fold. These sharp vertices occur in CAD parts.
Disc eared_strip(std::uint32_t faces, double corner, double ear) {
  Disc d;
  const auto add = [&](Vec3d p) {
    d.positions.push_back(p);
    return static_cast<std::uint32_t>(d.positions.size() - 1);
  };
  Vec3d at{0, 0, 0};
  std::array<std::uint32_t, 2> fold{add(at), add({0, 1, 0})};  // its lower and upper end
  std::array<std::uint32_t, 2> last{};                         // the corners of the ears left of it
  for (std::uint32_t k = 0; k < faces; ++k) {
    const double x = k % 2 == 0, z = 1 - x;
    const auto on_face = [&](double a, double y) { return add({at.x + a * x, y, at.z + a * z}); };
    const double size = ear * (1 + k % 3);
    const double a = size * std::sin(corner), b = -size * std::cos(corner);
    const double peak = -0.5 * std::cos(corner) / std::sin(corner);
    const std::array<std::uint32_t, 2> left{on_face(a, -b), on_face(a, 1 + b)};
    const std::array<std::uint32_t, 2> peaks{on_face(0.5, -peak), on_face(0.5, 1 + peak)};
    const std::array<std::uint32_t, 2> right{on_face(1 - a, -b), on_face(1 - a, 1 + b)};
    const std::array<std::uint32_t, 2> next{on_face(1, 0), on_face(1, 1)};
    const std::array<std::uint32_t, 10> rim{fold[0], left[0],  peaks[0], right[0], next[0],
                                            next[1], right[1], peaks[1], left[1],  fold[1]};
    const std::uint32_t centre = on_face(0.5, 0.5);
    for (std::uint32_t i = 0; i < 10; ++i)
      d.triangles.push_back({centre, rim[i], rim[(i + 1) % 10]});
    if (k > 0) {
      d.triangles.push_back({left[0], fold[0], last[0]});
      d.triangles.push_back({last[1], fold[1], left[1]});
    }
    at = {at.x + x, 0, at.z + z};
    fold = next;
    last = right;
  }
  return d;
}

// Returns the least L2 stretch that a random search finds from the given uvs, within the bound.
double searched_l2(const Disc& d, std::vector<Vec2d> uvs, double bound) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double least = measure_distortion(d.view(), uvs).stretch_l2, step = 0.01;
  for (int i = 0; i < 20000; ++i) {
    std::vector<Vec2d> next = uvs;
    for (Vec2d& p : next) p = {p.x + step * normal(random), p.y + step * normal(random)};
    const Distortion m = measure_distortion(d.view(), next);
    const bool better = m.flips == 0 && m.stretch_999 <= bound && m.stretch_l2 < least;
    step = std::max(1e-6, step * (better ? 1.5 : 0.93));
    if (!better) continue;
    least = m.stretch_l2;
    uvs = std::move(next);
  }
  return least;
}

// The flat faces must not stretch to relieve the ears: squeezed as far as possible, the faces would
// stretch twice as much as needed. Nor must they stretch to get below the bound.
TEST(Squeeze, FlatFacesDoNotGiveWayToASharpVertex) {
  for (const double degrees : {130.0, 140.0}) {
    for (const double ear : {0.06, 0.14}) {
      const Disc d = eared_strip(7, degrees * std::numbers::pi / 180, ear);
      param::FlattenOptions options{{.method = ParamMethod::isometric, .iterations = 30}};
      options.squeeze_iterations = 0;
      EXPECT_FALSE(run(d, options).within_bound);
      options.squeeze_iterations = 12;
      const ParamResult r = run_with(d, options);
      expect_consistent(d, r, options.max_stretch);
      ASSERT_TRUE(r.within_bound && r.injective);
      const double least = searched_l2(d, r.uvs, options.max_stretch);
      EXPECT_LT(r.distortion.stretch_l2 - 1, 1.2 * (least - 1)) << degrees << ", " << ear;
    }
  }
}

// On a curved surface, less of the largest stretch costs little L2 stretch.
TEST(Squeeze, CurvedSurfacesComeDownToTheBound) {
  const Disc d = testing::make_grid(30, 30, [](double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    return Vec3d{x, y, 0.55 * (x * x - y * y)};
  });
  param::FlattenOptions options{{.max_stretch = 1.25, .method = ParamMethod::isometric}};
  options.squeeze_iterations = 0;
  const Distortion before = run(d, options).distortion;
  options.squeeze_iterations = 12;
  options.max_stretch = 1 + 0.8 * (before.stretch_999 - 1);
  const Distortion after = run_with(d, options).distortion;
  EXPECT_LE(after.stretch_999, options.max_stretch);
  EXPECT_LT(after.stretch_l2 - 1, 1.4 * (before.stretch_l2 - 1));
}

// Whether a surface unrolls, is curved or is rough, and however few the iterations: the best state
// is kept, and the one before is as good as any.
TEST(Squeeze, NeverRaisesTheStretch) {
  Disc rough = testing::make_cap(0.8, 10);
  testing::add_radial_noise(rough, 0.4 * testing::mean_edge(rough), 3);
  Disc rougher = testing::make_cap(0.8, 10);
  testing::add_radial_noise(rougher, 0.9 * testing::mean_edge(rougher), 5);
  for (const Disc& d : {testing::make_cylinder(3, 1, 16, 6), testing::make_cap(0.8, 10), rough,
                        rougher, eared_strip(5, 2.3, 0.1)}) {
    for (const int iterations : {1, 2, 3, 5, 8, 20}) {
      for (const bool ratio : {false, true}) {
        ParamWorkspace workspace;
        const LocalMesh mesh = d.view();
        param::ArapSolver solver(mesh, {}, workspace.impl());
        std::vector<Vec2d> uvs(d.positions.size());
        solver.start(IsometricStart{});
        solver.iterate(30, uvs);
        const auto worst = [&] {
          if (!ratio) return measure_distortion(mesh, uvs).stretch_999;
          std::vector<TriangleStretch> s(d.triangles.size());
          measure_triangles(mesh, uvs, s);
          double greatest = 0, least = 1e300;
          for (const TriangleStretch& t : s) {
            greatest = std::max<double>(greatest, t.s1);
            least = std::min<double>(least, t.s2);
          }
          return greatest / least;
        };
        const double before = worst();
        solver.squeeze({1, iterations, ratio, false}, uvs);
        EXPECT_LE(worst(), before * (1 + 1e-6)) << iterations << " " << ratio;
      }
    }
  }
}

// Weights of an earlier squeeze are dropped.
TEST(Squeeze, ANewStartKnowsNothingOfIt) {
  const Disc d = testing::make_cap(1.1, 12);
  const LocalMesh mesh = d.view();
  std::vector<Vec2d> fresh(d.positions.size()), again = fresh;
  ParamWorkspace workspace, other;
  param::ArapSolver first(mesh, {}, workspace.impl()), second(mesh, {}, other.impl());
  first.start(IsometricStart{});
  first.iterate(5, fresh);
  second.start(IsometricStart{});
  second.iterate(5, again);
  second.squeeze({1, 5, false, false}, again);
  EXPECT_NE(again, fresh);
  second.start(IsometricStart{});
  second.iterate(5, again);
  EXPECT_EQ(again, fresh);
}

}  // namespace
}  // namespace atlas
