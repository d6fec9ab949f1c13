// The clearance that a chart's triangles and borders keep, so that small errors cannot flip or
// cross anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "libatlas/param/halfedges.h"
#include "libatlas/param/injectivity.h"
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

// The windings of a spiral band approach each other more and more. Of edges that have no common
// vertex, exactly those below the clearance are listed.
TEST(Clearance, CloseEdgesAreThoseOfAllPairs) {
  const Disc d = make_band(90, 0.3, [](double t) {
    const double a = 6 * std::numbers::pi * t, r = 1 + 1.2 * t * (1 - 0.06 * t);
    return Vec2d{r * std::cos(a), r * std::sin(a)};
  });
  const auto uv = drop_z(d);
  param::HalfEdges half_edges;
  half_edges.build(d.view());
  param::HalfEdges::Border border;
  half_edges.border(border);
  for (const double clearance : {0.02, 0.06, 0.09, 0.15}) {
    const Injectivity result =
        check_injectivity(d.view(), uv, {.clearance = clearance, .max_crossings = 100000});
    ASSERT_TRUE(result.injective);
    std::set<std::array<std::uint32_t, 2>> listed, wanted;
    for (const BorderCrossing& c : result.close) {
      if (c.a[1] == c.b[0] || c.b[1] == c.a[0]) continue;
      listed.insert({std::min(c.a[0], c.b[0]), std::max(c.a[0], c.b[0])});
    }
    for (const std::uint32_t g : border.half_edges) {
      for (const std::uint32_t h : border.half_edges) {
        const std::uint32_t a = half_edges.from(g), b = half_edges.to(g);
        const std::uint32_t p = half_edges.from(h), q = half_edges.to(h);
        if (g / 3 == h / 3 || a >= p || b == p || q == a) continue;
        const double gap = std::min({distance(uv[a], uv[p], uv[q]), distance(uv[b], uv[p], uv[q]),
                                     distance(uv[p], uv[a], uv[b]), distance(uv[q], uv[a], uv[b])});
        if (gap < clearance) wanted.insert({a, p});
      }
    }
    EXPECT_EQ(listed, wanted) << clearance;
    EXPECT_EQ(wanted.empty(), clearance < 0.05) << clearance;
  }
}

}  // namespace
}  // namespace atlas
