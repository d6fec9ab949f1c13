// The barrier relaxation on its own.
#include <gtest/gtest.h>

#include "libatlas/core/predicates.h"
#include "libatlas/param/relax.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;

struct System {
  std::vector<param::Element> elements;
  param::CornerLists corners;
};

System system_of(const Disc& d) {
  System s;
  param::build_elements(d.view(), 0, s.elements);
  s.corners.build(s.elements, d.positions.size());
  return s;
}

std::size_t flips(const Disc& d, const std::vector<Vec2d>& uv) {
  std::size_t count = 0;
  for (const auto& t : d.triangles) count += orientation(uv[t[0]], uv[t[1]], uv[t[2]]) <= 0;
  return count;
}

std::vector<Vec2d> flat(const Disc& d) {
  std::vector<Vec2d> uv;
  for (const Vec3d& p : d.positions) uv.push_back({p.x, p.y});
  return uv;
}

Disc plate(std::uint32_t n) {
  return testing::make_grid(n, n, [](double u, double v) { return Vec3d{u, v, 0}; });
}

// Far more than a chart may have left after the first rings.
TEST(Relax, ManyFlipsFarFromEachOtherAreAllTurned) {
  const std::uint32_t n = 80;
  const Disc d = plate(n);
  std::vector<Vec2d> uv = flat(d);
  for (std::uint32_t y = 4; y < n; y += 5) {
    for (std::uint32_t x = 4; x < n; x += 5) uv[y * (n + 1) + x].x += 2.3 / n;
  }
  const System s = system_of(d);
  ASSERT_GT(flips(d, uv), 400u);
  param::Relaxer relaxer;
  const param::Relaxer::Outcome out = relaxer.remove_flips(s.elements, s.corners, {}, uv);
  EXPECT_EQ(out.left, 0u);
  EXPECT_EQ(flips(d, uv), 0u);
  EXPECT_GT(out.turned, 400u);
}

// Half of it lies mirrored on the other half: no neighbourhood is the cause, so none wider than the
// first ring about the flips is moved.
TEST(Relax, AFoldedChartIsGivenUp) {
  const std::uint32_t n = 60;
  const Disc d = plate(n);
  std::vector<Vec2d> uv = flat(d);
  for (Vec2d& p : uv) {
    if (p.x > 0.5) p.x = 1 - p.x;
  }
  const std::vector<Vec2d> start = uv;
  const std::size_t before = flips(d, uv);
  ASSERT_GE(before, n * n);
  const System s = system_of(d);
  param::Relaxer relaxer;
  const param::Relaxer::Outcome out = relaxer.remove_flips(s.elements, s.corners, {}, uv);
  EXPECT_EQ(out.left, flips(d, uv));
  EXPECT_GT(out.left, before / 2);
  EXPECT_EQ(out.turned + out.left, before);
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x + 3 < n / 2; ++x) {
      EXPECT_EQ(uv[y * (n + 1) + x], start[y * (n + 1) + x]) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace atlas
