#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "libatlas/core/predicates.h"
#include "libatlas/param/injectivity.h"
#include "tests/param/oracles.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using testing::drop_z;
using testing::make_band;

TEST(Injectivity, MatchesExactPairsOnShakenGrids) {
  int injective = 0, not_injective = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> shake(0, 0.02 + 0.0012 * (seed % 50));
    Disc d = testing::make_grid(5, 4, [](double u, double v) { return Vec3d{u, v, 0}; });
    auto uv = drop_z(d);
    for (Vec2d& p : uv) p = {p.x + shake(random), p.y + shake(random)};
    const bool expected = testing::injective_by_pairs(d.view(), uv);
    const Injectivity result = check_injectivity(d.view(), uv);
    EXPECT_EQ(result.injective, expected) << "seed " << seed;
    (expected ? injective : not_injective)++;
  }
  EXPECT_GT(injective, 30);
  EXPECT_GT(not_injective, 30);
}

TEST(Injectivity, MatchesExactPairsOnIntegerGrids) {
  // Small integers make collinear, touching and coincident cases frequent.
  int injective = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> step(-1, 1);
    Disc d = testing::make_grid(3, 3, [](double u, double v) { return Vec3d{9 * u, 9 * v, 0}; });
    auto uv = drop_z(d);
    const int moves = seed % 6;
    for (int i = 0; i < moves; ++i) {
      Vec2d& p = uv[random() % uv.size()];
      p = {std::round(p.x) + 2 * step(random), std::round(p.y) + 2 * step(random)};
    }
    const bool expected = testing::injective_by_pairs(d.view(), uv);
    const Injectivity result = check_injectivity(d.view(), uv);
    // A border vertex on another border edge counts as a crossing, which is stricter than sharing
    // area.
    if (result.injective) {
      EXPECT_TRUE(expected) << "seed " << seed;
    } else if (expected) {
      EXPECT_FALSE(result.crossings.empty()) << "seed " << seed;
    }
    injective += result.injective;
  }
  EXPECT_GT(injective, 60);
}

TEST(Injectivity, SeesSpiralsApart) {
  const Disc spiral = make_band(200, 0.3, [](double t) {
    const double a = 6 * std::numbers::pi * t, r = 1 + 0.35 * 3 * t;  // three turns, 0.35 apart
    return Vec2d{r * std::cos(a), r * std::sin(a)};
  });
  const auto uv = drop_z(spiral);
  EXPECT_TRUE(check_injectivity(spiral.view(), uv).injective);
  EXPECT_TRUE(testing::injective_by_pairs(spiral.view(), uv));
}

TEST(Injectivity, ReportsALoopThatOverlapsItself) {
  // A ring of one and a half turns: every triangle is positive, but the band overlaps itself.
  const Disc d = make_band(90, 0.3, [](double t) {
    const double a = 3 * std::numbers::pi * t;
    return Vec2d{std::cos(a), std::sin(a)};
  });
  const auto uv = drop_z(d);
  const Injectivity result = check_injectivity(d.view(), uv);
  EXPECT_TRUE(result.flipped.empty());
  EXPECT_FALSE(result.injective);
  EXPECT_FALSE(result.crossings.empty());
  for (const BorderCrossing& c : result.crossings) {
    EXPECT_TRUE(segments_cross(uv[c.a[0]], uv[c.a[1]], uv[c.b[0]], uv[c.b[1]]));
  }
  ASSERT_GT(result.crossings.size(), 5u);
  for (const std::size_t most : {0u, 1u, 5u}) {
    const Injectivity some = check_injectivity(d.view(), uv, {.max_crossings = most});
    EXPECT_FALSE(some.injective) << most;
    EXPECT_EQ(some.crossings.size(), std::max<std::size_t>(most, 1)) << most;
  }
}

TEST(Injectivity, ReportsAVertexThatIsGoneRoundTwice) {
  // A fan of twice the full turn around an inner vertex: positive triangles that cover the area
  // twice.
  Disc d;
  std::vector<Vec2d> uv = {{0, 0}};
  const int n = 16;
  for (int i = 0; i < n; ++i) {
    const double a = 4 * std::numbers::pi * i / n, r = 1 + 0.01 * i;
    uv.push_back({r * std::cos(a), r * std::sin(a)});
    d.triangles.push_back({0, 1u + i, 1u + (i + 1) % n});
  }
  d.positions.assign(uv.size(), {});
  const Injectivity result = check_injectivity(d.view(), uv);
  EXPECT_TRUE(result.flipped.empty());
  EXPECT_FALSE(result.injective);
  EXPECT_FALSE(testing::injective_by_pairs(d.view(), uv));
}

TEST(Injectivity, ReportsTwoPiecesOnTopOfEachOther) {
  // Concentric squares that are not connected: no borders cross, but one lies in the other.
  Disc d;
  d.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  std::vector<Vec2d> uv = {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {1, 1}, {2, 1}, {2, 2}, {1, 2}};
  d.positions.assign(8, {});
  const Injectivity result = check_injectivity(d.view(), uv);
  EXPECT_TRUE(result.crossings.empty());
  EXPECT_TRUE(result.nested);
  EXPECT_FALSE(result.injective);
}

// The sides of a square have vertices between their ends. Wherever the list of triangles begins,
// and so the border, the square is on the inside.
TEST(Injectivity, ABorderMayBeginAnywhere) {
  for (const auto& [x, y] : {std::pair{1, 0}, {0, 1}, {-1, 0}, {0, -1}}) {  // the first side's way
    Disc d = testing::make_grid(4, 4, [&](double u, double v) {
      return Vec3d{x * u - y * v, y * u + x * v, 0};
    });
    for (std::size_t begin = 0; begin < d.triangles.size(); ++begin) {
      std::rotate(d.triangles.begin(), d.triangles.begin() + 1, d.triangles.end());
      EXPECT_TRUE(check_injectivity(d.view(), drop_z(d)).injective)
          << x << " " << y << " " << begin;
    }
  }
}

TEST(Injectivity, AcceptsARingWithAHole) {
  const Disc d = make_band(40, 0.3, [](double t) {
    const double a = 2 * std::numbers::pi * t;
    return Vec2d{std::cos(a), std::sin(a)};
  });
  Disc closed = d;  // the last column is welded to the first
  for (auto& t : closed.triangles) {
    for (auto& v : t) v = v == 40 ? 0 : v == 81 ? 41 : v;
  }
  const Injectivity result = check_injectivity(closed.view(), drop_z(d));
  EXPECT_EQ(result.loops, 2u);
  EXPECT_TRUE(result.injective);
}

TEST(Injectivity, DecidesTheLastDigit) {
  Disc d;
  d.positions.assign(3, {});
  d.triangles = {{0, 1, 2}};
  const double next = std::nextafter(0.1, 1);
  // Points on the diagonal; the middle one may be off by one step of a double.
  EXPECT_FALSE(
      check_injectivity(d.view(), std::vector<Vec2d>{{0, 0}, {0.3, 0.3}, {0.1, 0.1}}).injective);
  EXPECT_TRUE(
      check_injectivity(d.view(), std::vector<Vec2d>{{0, 0}, {0.3, 0.3}, {0.1, next}}).injective);
  EXPECT_FALSE(
      check_injectivity(d.view(), std::vector<Vec2d>{{0, 0}, {0.3, 0.3}, {next, 0.1}}).injective);
}

// A vertex lies on the opposite edge of a triangle. No border is involved.
TEST(Injectivity, AnInnerTriangleWithoutAreaCountsAsFlipped) {
  const Disc d = testing::make_grid(4, 4, [](double u, double v) { return Vec3d{u, v, 0}; });
  auto uv = drop_z(d);
  const auto triangle =
      std::find(d.triangles.begin(), d.triangles.end(), std::array<std::uint32_t, 3>{6, 7, 12});
  ASSERT_NE(triangle, d.triangles.end());
  uv[7] = {0.375, 0.375};  // between the vertices 6 and 12
  const Injectivity result = check_injectivity(d.view(), uv);
  EXPECT_FALSE(testing::injective_by_pairs(d.view(), uv));
  EXPECT_FALSE(result.injective);
  EXPECT_EQ(result.flipped, std::vector{std::uint32_t(triangle - d.triangles.begin())});
  EXPECT_TRUE(result.crossings.empty());
}

TEST(Injectivity, ManyBorderEdgesAreFast) {
  // 2 * 10^5 border edges of very unequal length. Quadratic work would take minutes.
  const Disc d = make_band(100000, 1e-3, [](double t) {
    const double a = 40 * std::numbers::pi * t * t, r = 0.1 + a;
    return Vec2d{r * std::cos(a), r * std::sin(a)};
  });
  EXPECT_TRUE(check_injectivity(d.view(), drop_z(d)).injective);
}

TEST(Injectivity, TeethAreFast) {
  // 2 * 10^5 teeth, the upright boxes of which overlap. Comparing all of these would take minutes.
  Disc d;
  const std::uint32_t n = 400000;
  d.positions = {{0, 0, 0}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n, r = i % 2 == 0 ? 1 : 1.5;
    d.positions.push_back({r * std::cos(a), r * std::sin(a), 0});
    d.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  EXPECT_TRUE(check_injectivity(d.view(), drop_z(d)).injective);
}

TEST(Injectivity, AHubIsFast) {
  // A fan of 4 * 10^5 triangles. A search for opposite half-edges among all triangles of the hub
  // would take a minute.
  Disc d;
  const std::uint32_t n = 400000;
  d.positions = {{0, 0, 0}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    d.positions.push_back({std::cos(a), std::sin(a), 0});
    d.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  const Injectivity result = check_injectivity(d.view(), drop_z(d));
  EXPECT_EQ(result.loops, 1u);
  EXPECT_TRUE(result.injective);
}

}  // namespace
}  // namespace atlas
