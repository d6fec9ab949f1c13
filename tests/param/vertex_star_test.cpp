// Compares the energy of a vertex's triangles, computed four at a time, with that of each triangle
// by its definition.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "libatlas/param/relaxing/vertex_star.h"

namespace atlas {
namespace {

using param::Element;
using param::VertexEnergy;
using param::VertexStar;
using Real = long double;  // finite differences of 64th powers need the digits

struct Triangle {
  Element element;
  std::uint32_t corner;
  std::array<glm::dvec2, 3> uvs;
  double weight;
};

struct Map {
  Real xx, xy, yx, yy;  // images of the unit vectors of the rest pose
  Real det() const { return xx * yy - xy * yx; }
  Real squared() const { return xx * xx + xy * xy + yx * yx + yy * yy; }
};

// Returns the linear map from the rest edges (length, 0) and (foot, altitude) to those of the uvs.
Map map_of(const Triangle& t, Real mx, Real my) {
  std::array<std::array<Real, 2>, 3> u;
  for (std::uint32_t k = 0; k < 3; ++k) {
    u[k] = {t.uvs[k].x + (k == t.corner ? mx : 0), t.uvs[k].y + (k == t.corner ? my : 0)};
  }
  const Real l = t.element.length, foot = t.element.foot, h = t.element.altitude;
  const auto columns = [&](int axis) {
    const Real x = (u[1][axis] - u[0][axis]) / l;
    return std::array<Real, 2>{x, (u[2][axis] - u[0][axis] - foot * x) / h};
  };
  const auto x = columns(0), y = columns(1);
  return {x[0], y[0], x[1], y[1]};
}

Real energy_of(const Map& map, const VertexStar::Kind& kind) {
  const Real f = map.squared(), d = map.det();
  if (kind.energy == VertexEnergy::untangling) {
    return (f + 1 + d * d) / ((d + std::sqrt(d * d + Real(kind.epsilon) * kind.epsilon)) / 2);
  }
  if (!(d > 0)) return std::numeric_limits<Real>::infinity();
  const Real root = std::sqrt(std::max<Real>(0, f * f - 4 * d * d));
  const Real large = std::sqrt((f + root) / 2), small = d / large;  // singular values
  const int power = kind.energy == VertexEnergy::high_power ? 64 : 2;
  return std::pow(large, power) + std::pow(small, power) + std::pow(large, -power) +
         std::pow(small, -power);
}

Real energy_of(const std::vector<Triangle>& star, const VertexStar::Kind& kind, Real mx, Real my) {
  Real sum = 0;
  for (const Triangle& t : star) sum += t.weight * energy_of(map_of(t, mx, my), kind);
  return sum;
}

// Returns triangles of about their rest size, rotated, and none too thin for finite differences.
std::vector<Triangle> random_star(std::size_t count, bool flipped, std::mt19937& random) {
  const auto in = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Triangle> star;
  while (star.size() < count) {
    Triangle t;
    t.element.v = {0, 1, 2};
    t.element.length = in(0.6, 1.5);
    t.element.foot = in(-0.4, 1.4);
    t.element.altitude = in(0.5, 1.5);
    t.corner = random() % 3;
    t.weight = in(0.1, 3);
    const double angle = in(0, 6.28), c = std::cos(angle), s = std::sin(angle);
    const bool over = flipped && random() % 3 == 0;
    const std::array<glm::dvec2, 3> rest{glm::dvec2(0), glm::dvec2(t.element.length, 0),
                                         glm::dvec2(t.element.foot, t.element.altitude)};
    for (int k = 0; k < 3; ++k) {
      const double x = rest[k].x + in(-0.05, 0.05);
      const double y = (over ? -1 : 1) * rest[k].y + in(-0.05, 0.05);
      t.uvs[k] = {3 + c * x - s * y, s * x + c * y - 2};
    }
    star.push_back(t);
  }
  return star;
}

// Loads several stars into the same object. Nothing of a larger one may remain.
class VertexStars : public ::testing::TestWithParam<VertexEnergy> {
 protected:
  const VertexStar& load(const std::vector<Triangle>& triangles) {
    star_.clear();
    EXPECT_TRUE(star_.empty());
    for (const Triangle& t : triangles) star_.add(t.element, t.corner, t.uvs, t.weight);
    star_.finish();
    EXPECT_EQ(star_.empty(), triangles.empty());
    return star_;
  }
  VertexStar::Kind kind() const { return {GetParam(), 0.03}; }
  bool flipped() const { return GetParam() == VertexEnergy::untangling; }

  VertexStar star_;
  std::mt19937 random_{7};
};

TEST_P(VertexStars, EnergyIsTheSumOfItsTriangles) {
  std::uniform_real_distribution<double> move(-0.03, 0.03);
  for (int round = 0; round < 20; ++round) {
    for (std::size_t count = 11; count > 0; --count) {
      const auto triangles = random_star(count, flipped(), random_);
      const VertexStar& star = load(triangles);
      const glm::dvec2 m(move(random_), move(random_));
      const double expected = double(energy_of(triangles, kind(), m.x, m.y));
      EXPECT_NEAR(star.energy(kind(), m), expected, 1e-10 * expected) << count;
    }
  }
}

TEST_P(VertexStars, DerivativesAreThoseOfTheEnergy) {
  const Real h = 1e-6L;
  for (int round = 0; round < 10; ++round) {
    for (std::size_t count = 1; count <= 11; ++count) {
      const auto triangles = random_star(count, false, random_);
      const VertexStar::Derivatives got = load(triangles).derivatives(kind());
      const auto e = [&](int x, int y) { return energy_of(triangles, kind(), x * h, y * h); };
      const Real still = e(0, 0);
      const Real xx = (e(1, 0) - 2 * still + e(-1, 0)) / (h * h);
      const Real yy = (e(0, 1) - 2 * still + e(0, -1)) / (h * h);
      const Real xy = (e(1, 1) - e(1, -1) - e(-1, 1) + e(-1, -1)) / (4 * h * h);
      const double first = 1e-6 * double(still + std::abs(xx) + std::abs(yy));
      const double second = 1e-5 * double(still + std::abs(xx) + std::abs(yy));
      EXPECT_NEAR(got.gradient.x, double((e(1, 0) - e(-1, 0)) / (2 * h)), first) << count;
      EXPECT_NEAR(got.gradient.y, double((e(0, 1) - e(0, -1)) / (2 * h)), first) << count;
      EXPECT_NEAR(got.xx, double(xx), second) << count;
      EXPECT_NEAR(got.yy, double(yy), second) << count;
      EXPECT_NEAR(got.xy, double(xy), second) << count;
    }
  }
}

TEST_P(VertexStars, EnergyIsInfiniteWhereATriangleWouldNotBePositive) {
  std::uniform_real_distribution<double> move(-1.5, 1.5);
  int infinite = 0, finite = 0;
  for (int round = 0; round < 300; ++round) {
    const auto triangles = random_star(1 + round % 5, false, random_);
    const double x = move(random_), y = move(random_);
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles) least = std::min(least, double(map_of(t, x, y).det()));
    const bool positive = least > 0;
    if (positive && least < 1e-3) continue;  // high powers of its stretch overflow
    ++(positive ? finite : infinite);
    const glm::dvec2 m(x, y);
    const double energy = load(triangles).energy(kind(), m);
    EXPECT_EQ(std::isfinite(energy), positive || flipped()) << energy;
    EXPECT_GT(energy, 0);
  }
  EXPECT_GT(infinite, 20);
  EXPECT_GT(finite, 20);
}

INSTANTIATE_TEST_SUITE_P(Energies, VertexStars,
                         ::testing::Values(VertexEnergy::untangling,
                                           VertexEnergy::symmetric_dirichlet,
                                           VertexEnergy::high_power));

TEST(VertexStar, StepsEndFourFifthsBeforeTheFirstTriangleThatTheyDegenerate) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> move(-2, 2);
  int whole = 0, shorter = 0;
  VertexStar star;
  for (int round = 0; round < 40; ++round) {
    for (std::size_t count = 11; count > 0; --count) {
      const auto triangles = random_star(count, false, random);
      const glm::dvec2 step(move(random), move(random));
      double expected = 1;
      star.clear();
      for (const Triangle& t : triangles) {
        star.add(t.element, t.corner, t.uvs, t.weight);
        const Real before = map_of(t, 0, 0).det();
        // The determinant is linear in the step.
        const Real change = map_of(t, step.x, step.y).det() - before;
        if (change < 0) expected = std::min(expected, double(-0.8L * before / change));
      }
      star.finish();
      EXPECT_NEAR(star.share_within(step), expected, 1e-12) << count;
      ++(expected < 1 ? shorter : whole);
    }
  }
  EXPECT_GT(whole, 10);
  EXPECT_GT(shorter, 100);
}

TEST(VertexStar, WithoutTrianglesNothingCountsAndStepsAreWhole) {
  VertexStar star;
  star.finish();
  EXPECT_TRUE(star.empty());
  EXPECT_EQ(star.energy({VertexEnergy::symmetric_dirichlet}, {1, 2}), 0);
  EXPECT_EQ(star.derivatives({VertexEnergy::high_power}).xx, 0);
  EXPECT_EQ(star.share_within({3, 4}), 1);
}

}  // namespace
}  // namespace atlas
