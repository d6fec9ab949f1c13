// Tests of what is said of a flattened chart: its scale, its bound, and what prevents it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "libatlas/core/predicates.h"
#include "libatlas/param/descent/judge.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

constexpr double kBound = 1.25;

ParamResult judged(const Disc& disc, const std::vector<Vec2d>& uvs,
                   const Distortion* known = nullptr) {
  ParamResult r;
  r.uvs = uvs;
  param::judge(disc.view(), {.max_stretch = kBound}, r, known);
  return r;
}

std::vector<double> stretch_of(const Disc& disc, const std::vector<Vec2d>& uvs) {
  std::vector<double> stretch(disc.triangles.size());
  measure_distortion(disc.view(), uvs, stretch);
  return stretch;
}

// A flat ring of a little more than one turn, whose ends overlap. One row of triangles is wider on
// the surface than in uv, and one vertex has crossed the triangles next to it.
struct FaultyRing {
  static constexpr std::uint32_t columns = 60, rows = 3;
  Disc disc;
  std::vector<Vec2d> uvs;

  FaultyRing() {
    const auto ring = [](double u, double v, double z) {
      const double angle = (2 * std::numbers::pi + 0.15) * u, r = 1.3 - 0.3 * v;
      return Vec3d{r * std::cos(angle), r * std::sin(angle), z};
    };
    disc = testing::make_grid(columns, rows, [&](double u, double v) {
      return ring(u, v, v < 0.9 ? 0 : 0.15 * (1 + u));
    });
    uvs = testing::drop_z(disc);
    const std::uint32_t inner = columns + 1 + columns / 2;
    uvs[inner] = {0.7 * uvs[inner].x, 0.7 * uvs[inner].y};
  }
};

TEST(Judge, OffendersAreFlipsThenCrossingsThenTheWorstStretched) {
  const FaultyRing ring;
  const Disc& d = ring.disc;
  const ParamResult r = judged(d, ring.uvs);
  const std::vector<double> stretch = stretch_of(d, r.uvs);
  std::set<std::uint32_t> flipped, crossing, beyond;
  for (std::uint32_t t = 0; t < d.triangles.size(); ++t) {
    const auto& v = d.triangles[t];
    if (orientation(r.uvs[v[0]], r.uvs[v[1]], r.uvs[v[2]]) <= 0) flipped.insert(t);
    if (stretch[t] > kBound) beyond.insert(t);
  }
  for (const BorderCrossing& c : r.crossings) crossing.insert({c.triangle_a, c.triangle_b});
  for (const std::uint32_t t : flipped) {
    crossing.erase(t);
    beyond.erase(t);
  }
  for (const std::uint32_t t : crossing) beyond.erase(t);
  ASSERT_GT(flipped.size(), 1u);
  ASSERT_GT(crossing.size(), 1u);
  ASSERT_GT(beyond.size(), 1u);
  ASSERT_EQ(r.offenders.size(), flipped.size() + crossing.size() + beyond.size());
  const auto first = r.offenders.begin();
  const auto second = first + std::ptrdiff_t(flipped.size());
  const auto third = second + std::ptrdiff_t(crossing.size());
  EXPECT_EQ(std::set(first, second), flipped);
  EXPECT_EQ(std::set(second, third), crossing);
  EXPECT_EQ(std::set(third, r.offenders.end()), beyond);
  EXPECT_TRUE(std::is_sorted(third, r.offenders.end(), [&](std::uint32_t a, std::uint32_t b) {
    return stretch[a] > stretch[b];
  }));
}

TEST(Judge, UvsAndTheirAreaAreThoseOfTheSurface) {
  const Disc d = testing::make_cap(0.6, 8);
  std::vector<Vec2d> uvs;
  for (const Vec3d& p : d.positions) uvs.push_back({3 * p.x, 3 * p.y});
  const ParamResult r = judged(d, uvs);
  double area = 0;
  for (const auto& v : d.triangles) {
    const Vec2d a = r.uvs[v[0]], b = r.uvs[v[1]], c = r.uvs[v[2]];
    area += 0.5 * ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
  }
  EXPECT_NEAR(area, r.distortion.surface_area, 1e-9 * area);
  EXPECT_NEAR(r.distortion.uv_area, area, 1e-9 * area);
}

TEST(Judge, AStretchEqualToTheBoundIsWithinIt) {
  const std::vector<double> stretch{1.25, 1.5, 1, 2};
  EXPECT_EQ(param::beyond_bound(stretch, 1.25), (std::vector<std::uint32_t>{3, 1}));
}

// A vertex of a flat plate has moved almost to its neighbour. The triangles between both are fewer
// than the share of the area that the bound leaves out, but raise the L2 stretch without limit.
struct PlateWithSlivers {
  static constexpr std::uint32_t side = 80;
  Disc disc = testing::make_grid(side, side, [](double u, double v) { return Vec3d{u, v, 0}; });
  std::vector<Vec2d> uvs;

  PlateWithSlivers() {
    uvs = testing::drop_z(disc);
    uvs[40 * (side + 1) + 40].x += (1 - 1e-4) / side;
  }
};

// Whoever has measured the stretch before gets the same answer, whatever the stretch.
TEST(Judge, AKnownDistortionSavesOnlyTheMeasuring) {
  const PlateWithSlivers plate;
  std::vector<Vec2d> sheared;
  for (const Vec3d& p : plate.disc.positions) sheared.push_back({p.x + 0.8 * p.y, p.y});
  for (const std::vector<Vec2d>& uvs : {plate.uvs, sheared}) {
    const Distortion known = measure_distortion(plate.disc.view(), uvs);
    const ParamResult fresh = judged(plate.disc, uvs), r = judged(plate.disc, uvs, &known);
    ASSERT_FALSE(fresh.within_bound);
    EXPECT_FALSE(r.within_bound);
    EXPECT_FALSE(fresh.offenders.empty());
    EXPECT_EQ(r.offenders, fresh.offenders);
    EXPECT_EQ(r.uvs, fresh.uvs);
  }
}

TEST(Judge, ASliverWithoutLimitIsBeyondTheBound) {
  const PlateWithSlivers plate;
  const ParamResult r = judged(plate.disc, plate.uvs);
  ASSERT_LT(r.distortion.stretch_999, kBound);
  EXPECT_GT(r.distortion.stretch_l2, kBound);
  EXPECT_FALSE(r.within_bound);
}

}  // namespace
}  // namespace atlas
