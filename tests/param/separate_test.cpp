// Borders that overlap are moved apart, or everything stays as it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "libatlas/param/distortion.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/repair/separate.h"
#include "tests/param/results.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using testing::drop_z;

// A flat ring of one turn and `excess` more, whose ends lie on each other. Waves along its borders
// make them cross in several places.
Disc overlapping_ring(double excess, double wave) {
  return testing::make_grid(90, 6, [=](double u, double v) {
    const double angle = (2 * std::numbers::pi + excess) * u;
    const double r = 1.5 - 0.5 * v + wave * (1 - 2 * v) * std::sin(17 * angle);
    return Vec3d{r * std::cos(angle), r * std::sin(angle), 0};
  });
}

struct Separated {
  bool apart;
  std::vector<Vec2d> uvs;
  std::vector<std::array<std::uint32_t, 2>> left;  // edges of the crossings that were left
};

Separated separate(const Disc& d, param::Relaxer& relaxer, param::Separator& separator) {
  param::Elements elements;
  param::CornerLists corners;
  elements.build(d.view(), 0);
  corners.build(elements, d.positions.size());
  const LocalMesh mesh = d.view();
  Separated out;
  out.uvs = testing::drop_z(d);
  separator.take(mesh, elements, corners);
  out.apart = separator.separate(relaxer, out.uvs);
  for (const BorderCrossing& c : separator.left()) out.left.insert(out.left.end(), {c.a, c.b});
  return out;
}

// One separator takes all charts one after the other, and nothing of an earlier chart remains.
TEST(Separate, BordersEndApartOrWhereTheyWere) {
  int apart = 0, as_before = 0;
  param::Relaxer relaxer;
  param::Separator separator;
  for (const double excess : {0.01, 0.03, 0.06, 0.1, 0.2, 0.3, 0.5, 1.0}) {
    for (const double wave : {0.0, 0.02, 0.05}) {
      const Disc d = overlapping_ring(excess, wave);
      const std::vector<Vec2d> before = testing::drop_z(d);
      ASSERT_FALSE(check_injectivity(d.view(), before).injective);
      const Separated r = separate(d, relaxer, separator);
      ++(r.apart ? apart : as_before);
      EXPECT_EQ(check_injectivity(d.view(), r.uvs).injective, r.apart) << excess << " " << wave;
      EXPECT_TRUE(r.apart || (r.uvs == before && !r.left.empty())) << excess << " " << wave;
      param::Relaxer fresh_relaxer;
      param::Separator fresh_separator;
      const Separated fresh = separate(d, fresh_relaxer, fresh_separator);
      EXPECT_EQ(r.uvs, fresh.uvs) << excess << " " << wave;
      EXPECT_EQ(r.left, fresh.left) << excess << " " << wave;
    }
  }
  EXPECT_GT(apart, 3);
  EXPECT_GT(as_before, 3);
}

// A slit of two edges in the middle of a plate. The vertices of its banks have changed sides, so
// that the hole is inside out. No edges cross, and no triangle is flipped.
TEST(Separate, HolesThatAreInsideOutAreTurned) {
  const std::uint32_t n = 20, middle = 10 * (n + 1) + 10;
  Disc d = testing::make_grid(n, n, [](double u, double v) { return Vec3d{u, v, 0}; });
  const auto left = static_cast<std::uint32_t>(d.positions.size());
  d.positions.push_back(d.positions[middle]);
  for (auto& triangle : d.triangles) {
    double x = 0;
    for (const std::uint32_t v : triangle) x += d.positions[v].x / 3;
    for (std::uint32_t& v : triangle) v = v == middle && x < 0.5 ? left : v;
  }
  const Disc flat = d;
  for (const double over : {0.1, 0.3}) {
    d = flat;
    d.positions[left].x += over / n;
    d.positions[middle].x -= over / n;
    const std::vector<Vec2d> before = testing::drop_z(d);
    const Injectivity check = check_injectivity(d.view(), before);
    ASSERT_TRUE(check.nested && check.crossings.empty() && check.flipped.empty());
    param::Relaxer relaxer;
    param::Separator separator;
    const Separated r = separate(d, relaxer, separator);
    EXPECT_TRUE(r.apart) << over;
    EXPECT_TRUE(check_injectivity(d.view(), r.uvs).injective) << over;
  }
}

// A slit from the right side to the middle of a plate. Near its end, the banks have changed sides,
// so that they cross each other once; the border goes around the end from one bank to the other.
TEST(Separate, BanksThatCrossNearTheEndOfASlitComeApart) {
  const std::uint32_t n = 20, row = 10;
  const Disc whole = testing::make_grid(n, n, [](double u, double v) { return Vec3d{u, v, 0}; });
  for (const std::uint32_t crossed : {1u, 2u, 3u, 4u}) {
    for (const double over : {0.1, 0.25}) {
      Disc d = whole;
      for (std::uint32_t i = n / 2 + 1; i <= n; ++i) {
        const std::uint32_t lower = row * (n + 1) + i;
        const auto upper = static_cast<std::uint32_t>(d.positions.size());
        d.positions.push_back(d.positions[lower]);
        const double shift = (i <= n / 2 + crossed ? over : -over) / n;
        d.positions[lower].y += shift;
        d.positions[upper].y -= shift;
        for (std::size_t t = 2 * n * row; t < d.triangles.size(); ++t)
          std::replace(d.triangles[t].begin(), d.triangles[t].end(), lower, upper);
      }
      const std::vector<Vec2d> before = testing::drop_z(d);
      const Injectivity check = check_injectivity(d.view(), before);
      ASSERT_TRUE(check.flipped.empty());
      ASSERT_EQ(check.crossings.size(), 1u);
      param::Relaxer relaxer;
      param::Separator separator;
      const Separated r = separate(d, relaxer, separator);
      EXPECT_TRUE(r.apart) << crossed << " " << over;
      EXPECT_TRUE(check_injectivity(d.view(), r.uvs).injective) << crossed << " " << over;
    }
  }
}

// Returns the mean over the surface of the symmetric Dirichlet energy, from singular values.
double dirichlet(const Disc& flat, const std::vector<Vec2d>& uvs) {
  std::vector<TriangleStretch> s(flat.triangles.size());
  measure_triangles(flat.view(), uvs, s);
  double sum = 0, area = 0;
  for (const TriangleStretch& t : s) {
    const double a = t.s1, b = t.s2;
    sum += t.area * (a * a + b * b + 1 / (a * a) + 1 / (b * b));
    area += t.area;
  }
  return sum / area;
}

// Settling spreads distortion over more triangles, and the borders stay apart. A bound that is only
// kept then is kept by parameterize().
TEST(Separate, SettlingFurtherLowersTheEnergy) {
  int settled = 0, tight = 0;
  for (const double excess : {0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.035, 0.04}) {
    const Disc d = overlapping_ring(excess, 0);
    param::Relaxer relaxer;
    param::Separator separator;
    param::Elements elements;
    param::CornerLists corners;
    elements.build(d.view(), 0);
    corners.build(elements, d.positions.size());
    const LocalMesh mesh = d.view();
    std::vector<Vec2d> uvs = drop_z(d);
    separator.take(mesh, elements, corners);
    if (!separator.separate(relaxer, uvs)) continue;
    const double before = dirichlet(d, uvs);
    const double stretch = measure_distortion(d.view(), uvs).stretch_999;
    separator.settle_further(relaxer, uvs);
    EXPECT_LE(dirichlet(d, uvs), before) << excess;
    EXPECT_TRUE(check_injectivity(d.view(), uvs).injective) << excess;
    const double lowered = measure_distortion(d.view(), uvs).stretch_999;
    ++settled;
    if (!(lowered - 1 < 0.99 * (stretch - 1))) continue;
    const ParamResult result = testing::run(d, {.max_stretch = 0.5 * (stretch + lowered)});
    EXPECT_TRUE(result.injective && result.within_bound) << excess;
    ++tight;
  }
  EXPECT_GT(settled, 2);
  EXPECT_GT(tight, 1);
}

}  // namespace
}  // namespace atlas
