#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/descent/planar.h"
#include "libatlas/param/parameterize.h"
#include "tests/param/oracles.h"
#include "tests/param/results.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using testing::expect_consistent;
using testing::joined;
using testing::run;
using testing::run_with;

TEST(Parameterize, ProjectsWhatIsNearlyFlat) {
  const Disc d = testing::make_grid(20, 20, [](double u, double v) {
    return Vec3d{u, v, 0.05 * std::sin(4 * u)};
  });
  const ParamResult r = run(d);
  expect_consistent(d, r, 1.25);
  EXPECT_TRUE(r.planar);
  EXPECT_TRUE(r.injective && r.within_bound);
  const ParamResult other = run(d, {.method = ParamMethod::isometric});
  EXPECT_FALSE(other.planar);
  EXPECT_LT(other.distortion.stretch_l2, r.distortion.stretch_l2);
}

// One vertex of a plate stands above its neighbour. Seen from above, the triangles between both are
// mere slivers: too little area for the bound, but the L2 stretch is far beyond it.
TEST(Parameterize, UnfoldsWhatAProjectionTurnsIntoSlivers) {
  const std::uint32_t n = 80;
  Disc d = testing::make_grid(n, n, [](double u, double v) { return Vec3d{u, v, 0}; });
  Vec3d& vertex = d.positions[40 * (n + 1) + 40];
  vertex = {vertex.x + (1 - 1e-5) / n, vertex.y, 0.6 / n};
  const ParamResult projected = run(d, {.method = ParamMethod::planar, .axis = {0, 0, 1}});
  ASSERT_LT(projected.distortion.stretch_999, 1.25);
  ASSERT_FALSE(projected.within_bound);
  const ParamResult r = run(d);
  expect_consistent(d, r, 1.25);
  EXPECT_FALSE(r.planar);
  EXPECT_TRUE(r.injective && r.within_bound);
  EXPECT_LT(measure_distortion(d.view(), r.uvs).stretch_l2, 1.01);
}

// Between solving and measuring, large meshes release the solver's memory.
TEST(Parameterize, LargeMeshesGoOnAfterTheyWereMeasured) {
  const Disc cylinder = testing::make_cylinder(5, 2, 500, 220);
  const ParamResult unrolled = run(cylinder, {.method = ParamMethod::isometric});
  EXPECT_TRUE(unrolled.injective);
  EXPECT_LT(unrolled.distortion.stretch_999, 1.001);
  const Disc cap = testing::make_cap(1.1, 190);
  param::FlattenOptions options{{.method = ParamMethod::isometric}};
  const double plain = run(cap, options).distortion.stretch_999;
  options.max_stretch = 1.1;  // cannot be reached, but is tried
  const ParamResult squeezed = run_with(cap, options);
  EXPECT_TRUE(squeezed.injective);
  EXPECT_LT(squeezed.distortion.stretch_999, plain);
}

// A band that winds more than twice around, so that its wavy sides cross in dozens of places.
// Squeezing would take long and not change that.
TEST(Parameterize, LargeMeshesThatCrossThemselvesAreNotSqueezed) {
  const auto band = [](int columns) {
    return testing::make_grid(columns, 10, [](double u, double v) {
      const double angle = 4.4 * std::numbers::pi * u;
      const double r = 1 + 0.5 * v + 0.1 * v * std::sin(17.5 * angle);
      return Vec3d{r * std::cos(angle), r * std::sin(angle),
                   0.05 * angle + 0.25 * std::sin(12 * angle) * std::sin(std::numbers::pi * v)};
    });
  };
  ParamOptions options{.method = ParamMethod::isometric};
  ParamOptions unsqueezed = options;
  unsqueezed.squeeze_iterations = 0;
  const Disc large = band(400), small = band(140);  // fewer than 3000 triangles
  const ParamResult crossing = run(large, options);
  EXPECT_FALSE(crossing.within_bound);
  EXPECT_GT(crossing.crossings.size(), 12u);
  EXPECT_TRUE(crossing.stubborn_crossings.empty());  // beyond the bound, nothing is moved apart
  EXPECT_TRUE(crossing.uvs == run(large, unsqueezed).uvs);
  EXPECT_FALSE(run(small, options).uvs == run(small, unsqueezed).uvs);
}

TEST(Parameterize, NoisyHemispheresHaveNoFlips) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Disc d = testing::make_cap(0.5 * std::numbers::pi, 24);
    testing::add_radial_noise(d, 0.15 * testing::mean_edge(d), seed);
    const ParamResult r = run(d, {.max_stretch = 3, .method = ParamMethod::isometric});
    expect_consistent(d, r, 3);
    EXPECT_EQ(r.distortion.flips, 0u);
    EXPECT_TRUE(r.injective) << seed;
  }
}

TEST(Parameterize, RemovesTheFlipsThatRoughNoiseBrings) {
  int turned = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    Disc d = testing::make_cap(0.45 * std::numbers::pi, 20);
    testing::add_radial_noise(d, 0.6 * testing::mean_edge(d), seed);
    const ParamResult r = run(d, {.max_stretch = 50, .method = ParamMethod::isometric});
    expect_consistent(d, r, 50);
    EXPECT_EQ(r.distortion.flips, 0u) << seed;
    turned += r.unflipped;
  }
  EXPECT_GT(turned, 0);
}

TEST(Parameterize, ReportsWhatCannotBeFlattenedWithoutOverlap) {
  // Two and a half turns of a helicoid's ramp near its axis overlap each other.
  const Disc d = testing::make_grid(100, 6, [](double u, double v) {
    const double a = 5 * std::numbers::pi * u, r = 1 + 0.5 * v;
    return Vec3d{r * std::cos(a), r * std::sin(a), 0.05 * a};
  });
  const ParamResult r = run(d, {.max_stretch = 1.2});
  expect_consistent(d, r, 1.2);
  EXPECT_FALSE(r.planar);
  EXPECT_FALSE(r.injective);
  EXPECT_FALSE(r.crossings.empty());
  EXPECT_FALSE(testing::injective_by_pairs(d.view(), r.uvs));
  EXPECT_TRUE(r.within_bound);
  EXPECT_FALSE(r.stubborn_crossings.empty());
  EXPECT_LE(r.stubborn_crossings.size(), r.crossings.size());
}

TEST(Parameterize, DrawsApartBordersThatOverlapALittle) {
  // A ramp of slightly more than a turn. Unrolled it overlaps by a sliver, which a little stretch
  // resolves.
  for (const double excess : {1e-9, 0.001, 0.01, 0.03}) {
    const Disc d = testing::make_grid(60, 4, [=](double u, double v) {
      const double a = (2 * std::numbers::pi + excess) * u, r = 1 + 0.5 * v;
      return Vec3d{r * std::cos(a), r * std::sin(a), 0.002 * a};
    });
    const ParamResult r = run(d);
    expect_consistent(d, r, 1.25);
    EXPECT_TRUE(r.injective && r.within_bound) << excess;
    EXPECT_TRUE(testing::injective_by_pairs(d.view(), r.uvs));
  }
}

// An overlap that is small relative to the chart's width spans many edges in a fine mesh.
TEST(Parameterize, DrawsApartWhateverTheMeshesFineness) {
  for (const int columns : {120, 360, 600, 1200}) {
    const Disc d = testing::make_grid(columns, columns / 15, [](double u, double v) {
      const double a = (2 * std::numbers::pi + 0.003) * u, r = 1 + 0.5 * v;
      return Vec3d{r * std::cos(a), r * std::sin(a), 0.002 * a};
    });
    const ParamResult r = run(d);
    EXPECT_TRUE(r.injective && r.within_bound) << columns;
    EXPECT_LT(r.distortion.stretch_999, 1.13) << columns;
  }
}

// Half a pipe, unrolled by its formula and stretched by a tenth. Each triangle is moved somewhere
// else, because only the gradients count. They are kept; a descent would have made them isometric.
TEST(Parameterize, JoinsFlatPartsAsTheyAre) {
  constexpr double stretch = 1.1;
  const Disc d = testing::make_grid(24, 8, [](double u, double v) {
    const double angle = std::numbers::pi * u;
    return Vec3d{std::cos(angle), v, std::sin(angle)};
  });
  // The chord of one of 24 steps, which is the grid's own length, so that the map is exact.
  const double step = 2 * std::sin(std::numbers::pi / 48);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-3, 3);
  std::vector<Vec2d> corners;
  for (const auto& triangle : d.triangles) {
    const Vec2d shift{anywhere(random), anywhere(random)};
    for (const std::uint32_t v : triangle) {
      const Vec3d p = d.positions[v];
      const double along = step * 24 * std::atan2(p.z, p.x) / std::numbers::pi;
      corners.push_back({stretch * along + shift.x, p.y / stretch + shift.y});
    }
  }
  ParamOptions options;
  options.method = ParamMethod::isometric;
  const ParamResult r = joined(d, {corners}, {options});
  expect_consistent(d, r, options.max_stretch);
  EXPECT_TRUE(r.injective && r.within_bound);
  std::vector<TriangleStretch> s(d.triangles.size());
  measure_triangles(d.view(), r.uvs, s);
  for (const TriangleStretch& t : s) {
    EXPECT_NEAR(t.s1, stretch, 1e-4);
    EXPECT_NEAR(t.s2, 1 / stretch, 1e-4);
  }
}

TEST(Parameterize, RecoversFromFramesThatLie) {
  // One frame for a whole cylinder: half of its triangles are seen from behind.
  const Disc d = testing::make_cylinder(5, 2, 60, 20);
  const std::vector<std::array<Vec3f, 2>> frames(d.triangles.size(),
                                                 {Vec3f{0, 1, 0}, Vec3f{0, 0, 1}});
  ParamOptions options;
  options.start.frames = [&](std::size_t t) { return frames[t]; };
  const ParamResult r = run(d, options);
  expect_consistent(d, r, 1.25);
  EXPECT_TRUE(r.injective);
  EXPECT_LT(r.distortion.stretch_linf, 1.01);
}

// Each triangle has its own frame with a random rotation. A descent from there does not remove the
// folds, but one that starts without the frames does.
TEST(Parameterize, RecoversFromFramesThatDisagree) {
  for (const Disc& d :
       {testing::make_cylinder(5, 2, 60, 20), testing::make_cone(0.5, 5.5, 60, 10)}) {
    for (unsigned seed = 0; seed < 3; ++seed) {
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
      std::vector<std::array<Vec3f, 2>> frames;
      for (const auto& t : d.triangles) {
        const auto at = [&](int k) { return to_glm(d.positions[t[k]]); };
        const glm::dvec3 along = glm::normalize(at(1) - at(0));
        const glm::dvec3 normal = glm::normalize(glm::cross(along, at(2) - at(0)));
        const double a = angle(random);
        const glm::dvec3 u = std::cos(a) * along + std::sin(a) * glm::cross(normal, along);
        const glm::dvec3 v = glm::cross(normal, u);
        frames.push_back(
            {Vec3f{float(u.x), float(u.y), float(u.z)}, Vec3f{float(v.x), float(v.y), float(v.z)}});
      }
      ParamOptions options;
      options.start.frames = [&](std::size_t t) { return frames[t]; };
      const ParamResult r = run(d, options);
      expect_consistent(d, r, 1.25);
      EXPECT_TRUE(r.injective) << seed;
      EXPECT_LT(r.distortion.stretch_linf, 1.01) << seed;
    }
  }
}

TEST(Parameterize, ReportsTheTipThatBreaksTheBound) {
  // A needle on a plate. Nothing flattens it within 1.25, and its triangles are the worst ones.
  const Disc d = testing::make_rings(12, [](double r, double angle) {
    return Vec3d{r * std::cos(angle), r * std::sin(angle), r < 0.3 ? 3 * (0.3 - r) : 0};
  });
  const ParamResult r = run(d);
  expect_consistent(d, r, 1.25);
  ASSERT_FALSE(r.within_bound);
  const Vec3d p = d.positions[d.triangles[r.offenders[0]][0]];
  EXPECT_LT(std::hypot(p.x, p.y), 0.6);
}

TEST(Parameterize, SliversDoNotSinkTheirChart) {
  for (const double aspect : {1e2, 1e4, 1e6, 1e8, 1e10, 1e12}) {
    // Columns on a cylinder alternate between wide ones and slivers of the given aspect.
    const std::uint32_t n = 20;
    const Disc d = testing::make_grid(n, n, [&](double u, double v) {
      const auto i = static_cast<std::uint32_t>(std::lround(u * n));
      const double a = 2.0 * (i / 2) / (n / 2) + (i % 2) * 0.1 / aspect;
      return Vec3d{std::cos(a), std::sin(a), 2 * v};
    });
    const ParamResult r = run(d, {.method = ParamMethod::isometric});
    expect_consistent(d, r, 1.25);
    EXPECT_TRUE(r.injective) << aspect;
    EXPECT_LT(r.distortion.stretch_999, 1.01) << aspect;
  }
}

TEST(Parameterize, ZeroAreaTrianglesGetAPlace) {
  // One row of the grid is collapsed onto its neighbour, one vertex is doubled, and one lies on an
  // edge.
  Disc d = testing::make_grid(10, 10, [](double u, double v) {
    return Vec3d{u, std::abs(v - 0.5) < 1e-9 ? 0.4 : v, 0.2 * std::sin(3 * u)};
  });
  d.positions[3] = d.positions[4];
  const ParamResult r = run(d, {.method = ParamMethod::isometric});
  expect_consistent(d, r, 1.25);
  EXPECT_TRUE(r.injective);
  EXPECT_LT(r.distortion.stretch_l2, 1.01);
}

TEST(Parameterize, NothingButPointsStillHasUvs) {
  Disc d;
  d.positions.assign(3, Vec3d{4, 5, 6});
  d.triangles = {{0, 1, 2}};
  const ParamResult r = run(d, {.min_altitude = 1e-3});
  expect_consistent(d, r, 1.25);
  EXPECT_TRUE(r.injective);
}

TEST(Parameterize, SingleTrianglesAreIsometric) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    Disc d;
    for (int k = 0; k < 3; ++k)
      d.positions.push_back({normal(random), normal(random), normal(random)});
    d.triangles = {{0, 1, 2}};
    const ParamResult r = run(d, {.max_stretch = 1.001});
    expect_consistent(d, r, 1.001);
    EXPECT_TRUE(r.injective && r.within_bound);
    EXPECT_LT(r.distortion.stretch_linf, 1 + 1e-6);
  }
}

TEST(Parameterize, ScaleChangesNothing) {
  Disc d = testing::make_cap(1.2, 16);
  testing::add_radial_noise(d, 0.05 * testing::mean_edge(d), 3);
  const ParamResult plain = run(d);
  for (const double scale : {1e-12, 1e-6, 0.7, 1e6, 1e12}) {
    Disc scaled = d;
    testing::transform(scaled, scale);
    const ParamResult r = run(scaled);
    expect_consistent(scaled, r, 1.25);
    EXPECT_NEAR(r.distortion.stretch_l2, plain.distortion.stretch_l2, 1e-6);
    EXPECT_NEAR(r.distortion.stretch_999, plain.distortion.stretch_999, 1e-4);
    EXPECT_EQ(r.injective, plain.injective);
  }
}

// Areas are beyond what doubles hold there, but lengths and their ratios are not.
TEST(Parameterize, NoUnitIsTooLongOrTooShort) {
  Disc d = testing::make_cap(1.2, 16);
  testing::add_radial_noise(d, 0.05 * testing::mean_edge(d), 3);
  const std::vector<double> density(d.triangles.size(), 3.0);
  for (const ParamMethod method : {ParamMethod::isometric, ParamMethod::planar}) {
    for (const bool dense : {false, true}) {
      const auto flatten = [&](const Disc& disc, const ParamOptions& options) {
        ParamWorkspace workspace;
        LocalMesh mesh = disc.view();
        if (dense) mesh.density = density;
        return parameterize(mesh, options, workspace).value();
      };
      const ParamResult plain = flatten(d, {.method = method, .min_altitude = 1e-6});
      for (const int power : {-1000, -500, -120, 120, 333, 1000}) {
        Disc scaled = d;
        for (Vec3d& p : scaled.positions)
          p = {std::ldexp(p.x, power), std::ldexp(p.y, power), std::ldexp(p.z, power)};
        const ParamResult r =
            flatten(scaled, {.method = method, .min_altitude = std::ldexp(1e-6, power)});
        EXPECT_EQ(r.distortion.stretch_l2, plain.distortion.stretch_l2) << power;
        EXPECT_EQ(r.within_bound, plain.within_bound) << power;
        EXPECT_EQ(r.injective, plain.injective) << power;
        EXPECT_EQ(r.distortion.uv_area, std::ldexp(plain.distortion.uv_area, 2 * power));
        ASSERT_EQ(r.uvs.size(), plain.uvs.size());
        for (std::size_t v = 0; v < r.uvs.size(); ++v) {
          EXPECT_EQ(r.uvs[v].x, std::ldexp(plain.uvs[v].x, power)) << power;
          EXPECT_EQ(r.uvs[v].y, std::ldexp(plain.uvs[v].y, power)) << power;
        }
      }
    }
  }
}

TEST(Parameterize, TheLengthOfTheAxisDoesNotMatter) {
  const Disc d = testing::make_cap(0.4, 8);
  const auto along = [&](Vec3d axis) {
    return run(d, {.method = ParamMethod::planar, .axis = axis});
  };
  const ParamResult unit = along({0.5, 0, 1}), mean = along({});
  for (const int power : {-1060, -700, -3, 700, 1020}) {
    const ParamResult r = along({std::ldexp(0.5, power), 0, std::ldexp(1.0, power)});
    EXPECT_EQ(r.uvs, unit.uvs) << power;
  }
  for (const double bad : {double(NAN), double(INFINITY)})
    EXPECT_EQ(along({bad, 0, 1}).uvs, mean.uvs) << bad;
}

TEST(Parameterize, WithoutTrianglesNothingIsFlat) {
  Disc d;
  for (const std::size_t points : {0, 3}) {
    d.positions.assign(points, Vec3d{1, 2, 3});
    const ParamResult r = run(d);
    EXPECT_EQ(r.uvs, std::vector<Vec2d>(points));
    EXPECT_FALSE(r.injective || r.within_bound);
    EXPECT_TRUE(r.offenders.empty());
  }
}

TEST(Parameterize, FanOfAHundredThousandNeedles) {
  Disc d;
  const std::uint32_t n = 100000;
  d.positions.push_back({0, 0, 0.5});
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    d.positions.push_back({std::cos(a), std::sin(a), 0});
    d.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  const ParamResult r = run(d, {.max_stretch = 1.3, .method = ParamMethod::isometric});
  expect_consistent(d, r, 1.3);
  EXPECT_TRUE(r.injective);
}

TEST(Parameterize, MinimumAltitudeSurvivesRounding) {
  Disc d = testing::make_grid(30, 30, [](double u, double v) {
    return Vec3d{u, std::abs(v - 0.5) < 1e-9 ? 0.466666667 : v, 0};
  });
  const double altitude = 1e-5;
  const ParamResult r = run(d, {.method = ParamMethod::isometric, .min_altitude = altitude});
  const Injectivity check = check_injectivity(d.view(), r.uvs, {.clearance = 0.3 * altitude});
  EXPECT_TRUE(check.injective);
  EXPECT_TRUE(check.thin.empty()) << check.thin.size();
}

TEST(Parameterize, SameBytesEveryTime) {
  Disc d = testing::make_cap(1.3, 40);
  testing::add_radial_noise(d, 0.3 * testing::mean_edge(d), 9);
  EXPECT_EQ(run(d).uvs, run(d).uvs);
}

}  // namespace
}  // namespace atlas
