// The clearance that a chart's triangles and borders keep, so that small errors cannot flip or
// cross anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <span>

#include "libatlas/param/injectivity.h"
#include "libatlas/param/mesh/halfedges.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using testing::drop_z;
using testing::make_band;

TEST(Clearance, SurvivesRounding) {
  const Disc d = testing::make_grid(6, 6, [](double u, double v) { return Vec3d{u, v, 0}; });
  std::mt19937 random(1);
  for (const double e : {1e-3, 1e-2}) {
    auto uv = drop_z(d);
    std::uniform_real_distribution<double> shake(-0.04, 0.04), error(-e, e);
    for (Vec2d& p : uv) p = {p.x + shake(random), p.y + shake(random)};
    const Injectivity result = check_injectivity(d.view(), uv, {.clearance = 3 * e});
    ASSERT_TRUE(result.injective);
    ASSERT_TRUE(result.thin.empty() && result.close.empty());
    for (int i = 0; i < 50; ++i) {
      auto rounded = uv;
      for (Vec2d& p : rounded) p = {p.x + error(random), p.y + error(random)};
      EXPECT_TRUE(check_injectivity(d.view(), rounded).injective);
    }
  }
  const auto uv = drop_z(d);
  EXPECT_EQ(check_injectivity(d.view(), uv, {.clearance = 0.2}).thin.size(), d.triangles.size());
}

TEST(Clearance, FindsACloseSlit) {
  // A square with a slit from one side; the two sides of the slit are 1e-6 apart.
  Disc d;
  d.triangles = {{0, 1, 3}, {1, 2, 3}, {3, 4, 0}, {4, 5, 0}};
  const std::vector<Vec2d> uv = {{0, 0}, {2, -1}, {2, -1e-6}, {0.5, 0}, {2, 1e-6}, {2, 1}};
  d.positions.assign(6, {});
  const Injectivity result = check_injectivity(d.view(), uv, {.clearance = 1e-4});
  EXPECT_TRUE(result.injective);
  bool found = false;
  for (const BorderCrossing& c : result.close) {
    found |= (c.a[0] == 3 || c.a[1] == 3) && (c.b[0] == 3 || c.b[1] == 3);
  }
  EXPECT_TRUE(found);
}

double distance(Vec2d p, Vec2d a, Vec2d b) {
  const double x = b.x - a.x, y = b.y - a.y;
  const double t = std::clamp(((p.x - a.x) * x + (p.y - a.y) * y) / (x * x + y * y), 0.0, 1.0);
  return std::hypot(p.x - a.x - t * x, p.y - a.y - t * y);
}

using Pairs = std::set<std::array<std::uint32_t, 2>>;  // of the vertices where edges begin

// Returns the pairs of border edges of different triangles of which an end, unless they share it,
// is closer to the other edge than the clearance.
Pairs close_pairs(const Disc& d, std::span<const Vec2d> uv, double clearance) {
  param::HalfEdges half_edges;
  half_edges.build(d.view());
  param::HalfEdges::Border border;
  half_edges.border(border);
  Pairs pairs;
  for (const std::uint32_t g : border.half_edges) {
    for (const std::uint32_t h : border.half_edges) {
      const std::array e{half_edges.from(g), half_edges.to(g)};
      const std::array f{half_edges.from(h), half_edges.to(h)};
      if (g / 3 == h / 3) continue;
      double gap = 1e300;
      for (const std::uint32_t v : e) {
        if (v != f[0] && v != f[1]) gap = std::min(gap, distance(uv[v], uv[f[0]], uv[f[1]]));
      }
      for (const std::uint32_t v : f) {
        if (v != e[0] && v != e[1]) gap = std::min(gap, distance(uv[v], uv[e[0]], uv[e[1]]));
      }
      if (gap < clearance) pairs.insert({std::min(e[0], f[0]), std::max(e[0], f[0])});
    }
  }
  return pairs;
}

Pairs listed_pairs(const Disc& d, std::span<const Vec2d> uv, double clearance) {
  const Injectivity result =
      check_injectivity(d.view(), uv, {.clearance = clearance, .max_crossings = 100000});
  EXPECT_TRUE(result.injective);
  Pairs pairs;
  for (const BorderCrossing& c : result.close)
    pairs.insert({std::min(c.a[0], c.b[0]), std::max(c.a[0], c.b[0])});
  return pairs;
}

// The windings of a spiral band approach each other more and more.
TEST(Clearance, CloseEdgesAreThoseOfAllPairs) {
  const Disc d = make_band(90, 0.3, [](double t) {
    const double a = 6 * std::numbers::pi * t, r = 1 + 1.2 * t * (1 - 0.06 * t);
    return Vec2d{r * std::cos(a), r * std::sin(a)};
  });
  const auto uv = drop_z(d);
  for (const double clearance : {0.02, 0.06, 0.09, 0.15, 0.4}) {
    const Pairs wanted = close_pairs(d, uv, clearance);
    EXPECT_EQ(listed_pairs(d, uv, clearance), wanted) << clearance;
    EXPECT_EQ(wanted.empty(), clearance < 0.05) << clearance;
  }
}

// Edges that meet in the tips and notches of a star have very unequal lengths.
TEST(Clearance, SharpCornersAreCloseByTheirShorterEdge) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> radius(0.1, 1);
    Disc star;
    star.positions = {{0, 0, 0}};
    const std::uint32_t n = 24;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n, r = radius(random);
      star.positions.push_back({r * std::cos(a), r * std::sin(a), 0});
      star.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    }
    const auto uv = drop_z(star);
    for (const double clearance : {0.01, 0.03, 0.1, 0.3}) {
      const Pairs wanted = close_pairs(star, uv, clearance);
      EXPECT_EQ(listed_pairs(star, uv, clearance), wanted) << seed << " " << clearance;
      found += wanted.size();
    }
  }
  EXPECT_GT(found, 100u);
}

// The teeth of a saw lie beside each other, so that boxes that lie along them tell them apart.
TEST(Clearance, TeethAreCloseToTheirNeighbours) {
  Disc saw;
  saw.positions = {{0, 0, 0}};
  const std::uint32_t n = 600;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> radius(0.9, 1.1);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n, r = (i % 2 == 0 ? 1 : 1.5) * radius(random);
    saw.positions.push_back({r * std::cos(a), r * std::sin(a), 0});
    saw.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  const auto uv = drop_z(saw);
  for (const double clearance : {0.001, 0.01, 0.03, 0.1}) {
    const Pairs wanted = close_pairs(saw, uv, clearance);
    EXPECT_EQ(listed_pairs(saw, uv, clearance), wanted) << clearance;
    EXPECT_EQ(wanted.size() > n, clearance > 0.02) << clearance;
  }
}

TEST(Clearance, ListsNoMorePairsThanAskedFor) {
  const Disc d = testing::make_grid(6, 6, [](double u, double v) { return Vec3d{u, v, 0}; });
  const auto uv = drop_z(d);
  ASSERT_GT(listed_pairs(d, uv, 0.3).size(), 5u);
  for (const std::size_t most : {1u, 2u, 5u}) {
    const Injectivity result =
        check_injectivity(d.view(), uv, {.clearance = 0.3, .max_crossings = most});
    EXPECT_TRUE(result.injective);
    EXPECT_EQ(result.close.size(), most);
  }
}

}  // namespace
}  // namespace atlas
