// Tests of the barrier relaxation alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libatlas/core/predicates.h"
#include "libatlas/param/distortion.h"
#include "libatlas/param/relaxing/relax.h"
#include "libatlas/param/relaxing/vertex_energy.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

struct RelaxSystem {
  param::Elements elements;
  param::CornerLists corners;
};

RelaxSystem system_of(const Disc& d) {
  RelaxSystem s;
  s.elements.build(d.view(), 0);
  s.corners.build(s.elements, d.positions.size());
  return s;
}

std::size_t flips(const Disc& d, const std::vector<Vec2d>& uv) {
  std::size_t count = 0;
  for (const auto& t : d.triangles) count += orientation(uv[t[0]], uv[t[1]], uv[t[2]]) <= 0;
  return count;
}

Disc plate(std::uint32_t n) {
  return testing::make_grid(n, n, [](double u, double v) { return Vec3d{u, v, 0}; });
}

// There are far more flips than a chart may have left after the first rings.
TEST(Relax, ManyFlipsFarFromEachOtherAreAllTurned) {
  const std::uint32_t n = 80;
  const Disc d = plate(n);
  std::vector<Vec2d> uv = testing::drop_z(d);
  for (std::uint32_t y = 4; y < n; y += 5) {
    for (std::uint32_t x = 4; x < n; x += 5) uv[y * (n + 1) + x].x += 2.3 / n;
  }
  const RelaxSystem s = system_of(d);
  ASSERT_GT(flips(d, uv), 400u);
  param::Relaxer relaxer;
  const param::Relaxer::Outcome out = relaxer.remove_flips(s.elements, s.corners, false, uv);
  EXPECT_EQ(out.left, 0u);
  EXPECT_EQ(flips(d, uv), 0u);
  EXPECT_GT(out.turned, 400u);
}

// One half of the chart lies mirrored on the other. No local cause exists, so nothing beyond the
// first ring around the flips moves.
TEST(Relax, AFoldedChartIsGivenUp) {
  const std::uint32_t n = 60;
  const Disc d = plate(n);
  std::vector<Vec2d> uv = testing::drop_z(d);
  for (Vec2d& p : uv) {
    if (p.x > 0.5) p.x = 1 - p.x;
  }
  const std::vector<Vec2d> start = uv;
  const std::size_t before = flips(d, uv);
  ASSERT_GE(before, n * n);
  const RelaxSystem s = system_of(d);
  param::Relaxer relaxer;
  const param::Relaxer::Outcome out = relaxer.remove_flips(s.elements, s.corners, false, uv);
  EXPECT_EQ(out.left, flips(d, uv));
  EXPECT_GT(out.left, before / 2);
  EXPECT_EQ(out.turned + out.left, before);
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x + 3 < n / 2; ++x) {
      EXPECT_EQ(uv[y * (n + 1) + x], start[y * (n + 1) + x]) << x << " " << y;
    }
  }
}

// Compares with values computed directly from singular values, and with finite differences.
TEST(Relax, TheHighPowerAndItsDerivativesAreRight) {
  const double power = 2 * std::exp2(param::doublings);
  for (const auto& stretches : {std::pair{1.25, 0.8}, {1.1, 1.05}, {0.9, 0.7}, {1.4, 1.0}}) {
    const double a = stretches.first, b = stretches.second;
    const double f = a * a + b * b, d = a * b;
    const double wanted =
        std::pow(a, power) + std::pow(b, power) + std::pow(a, -power) + std::pow(b, -power);
    EXPECT_NEAR(param::high_power<double>(f, d) / wanted, 1, 1e-9);
    const param::EnergyDerivatives<double> p = param::high_power_derivatives<double>(f, d);
    const double e = 1e-6;
    const auto by = [&](auto&& g, double df, double dd) {
      return (g(f + df, d + dd) - g(f - df, d - dd)) / (2 * e);
    };
    const auto near = [&](double got, double difference) {
      EXPECT_NEAR(got, difference, 1e-5 * std::abs(difference)) << a << " " << b;
    };
    const auto value = [](double x, double y) { return param::high_power<double>(x, y); };
    near(p.f, by(value, e, 0));
    near(p.d, by(value, 0, e));
    const auto slope_f = [](double x, double y) {
      return param::high_power_derivatives<double>(x, y).f;
    };
    const auto slope_d = [](double x, double y) {
      return param::high_power_derivatives<double>(x, y).d;
    };
    near(p.ff, by(slope_f, e, 0));
    near(p.fd, by(slope_f, 0, e));
    near(p.dd, by(slope_d, 0, e));
  }
}

// Spikes of scan noise that are far from each other: vertices that are not near them do not move.
TEST(Relax, TheTailIsLoweredWhereItIs) {
  const std::uint32_t n = 60;
  Disc d = plate(n);
  const std::vector<Vec2d> start = testing::drop_z(d);
  const auto spike = [](std::uint32_t i) { return i % 20 == 10; };
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      if (spike(x) && spike(y)) d.positions[y * (n + 1) + x].z = 0.85 / n;
    }
  }
  std::vector<Vec2d> uv = start;
  ASSERT_GT(measure_distortion(d.view(), uv).stretch_999, 1.25);
  const RelaxSystem s = system_of(d);
  param::Relaxer relaxer;
  EXPECT_EQ(relaxer.lower_tail(s.elements, s.corners, 1.25, uv), param::Tail::lowered);
  EXPECT_LE(measure_distortion(d.view(), uv).stretch_999, 1.25);
  EXPECT_EQ(flips(d, uv), 0u);
  std::size_t moved = 0;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const auto near = [&](std::uint32_t i) { return i % 20 >= 3 && i % 20 <= 17; };
      const bool same = uv[y * (n + 1) + x] == start[y * (n + 1) + x];
      moved += !same;
      EXPECT_TRUE(same || (near(x) && near(y))) << x << " " << y;
    }
  }
  EXPECT_GT(moved, 9u);
}

TEST(Relax, ATailThatIsTheWholeChartIsLeftAlone) {
  const Disc d = testing::make_cap(1.3, 20);
  std::vector<Vec2d> uv = testing::drop_z(d);
  const std::vector<Vec2d> start = uv;
  const RelaxSystem s = system_of(d);
  param::Relaxer relaxer;
  EXPECT_EQ(relaxer.lower_tail(s.elements, s.corners, 1.05, uv), param::Tail::wide);
  EXPECT_TRUE(std::equal(uv.begin(), uv.end(), start.begin()));
}

// A plate on which some vertices, far from each other, have moved almost to a neighbour. A
// thousandth of the area, which is twelve of these triangles, may stay as it is.
TEST(Relax, TheTailBeginsBeyondAThousandthOfTheArea) {
  const std::uint32_t n = 80;
  const double bound = 1.25;
  const Disc d = plate(n);
  const RelaxSystem s = system_of(d);
  int within = 0, beyond = 0;
  for (std::uint32_t moved = 0; moved < 6; ++moved) {
    std::vector<Vec2d> uv = testing::drop_z(d);
    for (std::uint32_t i = 0; i < moved; ++i) uv[(10 + 12 * i) * (n + 1) + 40].x += 0.7 / n;
    const std::vector<Vec2d> start = uv;
    const bool reached = measure_distortion(d.view(), uv).stretch_999 <= bound;
    ++(reached ? within : beyond);
    param::Relaxer relaxer;
    EXPECT_EQ(relaxer.lower_tail(s.elements, s.corners, bound, uv), param::Tail::lowered) << moved;
    EXPECT_EQ(uv == start, reached) << moved;
    EXPECT_LE(measure_distortion(d.view(), uv).stretch_999, bound) << moved;
  }
  EXPECT_GT(within, 1);
  EXPECT_GT(beyond, 1);
}

// An isometry at another scale has no tail.
TEST(Relax, TheTailIsMeasuredAtTheChartsOwnScale) {
  const Disc d = plate(20);
  const RelaxSystem s = system_of(d);
  for (const double scale : {0.5, 0.75, 1.4, 2.0}) {
    std::vector<Vec2d> uv = testing::drop_z(d);
    for (Vec2d& p : uv) p = {scale * p.x, scale * p.y};
    const std::vector<Vec2d> start = uv;
    param::Relaxer relaxer;
    EXPECT_EQ(relaxer.lower_tail(s.elements, s.corners, 1.25, uv), param::Tail::lowered) << scale;
    EXPECT_EQ(uv, start) << scale;
  }
}

// By symmetry the energy is least in the middle, wherever the vertex starts.
TEST(Relax, AVertexWithinAFixedSquareGoesToTheMiddle) {
  Disc d;
  d.positions = {{0, 0, 0}, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  d.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  const RelaxSystem s = system_of(d);
  const std::vector<std::uint32_t> all{0, 1, 2, 3};
  for (const double far : {0.1, 0.5, 0.9, 0.99}) {
    for (const Vec2d at : {Vec2d{far, 0}, {0, far}, {-far, 0}, {0, -far}, {far, 0.7 * far}}) {
      std::vector<Vec2d> uv = testing::drop_z(d);
      uv[0] = at;
      param::Relaxer relaxer;
      for (int i = 0; i < 3; ++i) relaxer.smooth(s.elements, s.corners, {all, false}, uv);
      EXPECT_NEAR(uv[0].x, 0, 1e-6) << at.x << " " << at.y;
      EXPECT_NEAR(uv[0].y, 0, 1e-6) << at.x << " " << at.y;
    }
  }
}

}  // namespace
}  // namespace atlas
