// Opening stacks and spreading specks leaves no more thin triangles than there were, and takes
// bounded time.
#include "libatlas/uvs/spread_specks.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/uvs/open_stacks.h"
#include "libatlas/uvs/round_uvs.h"
#include "libatlas/uvs/thin_uvs.h"
#include "tests/support/slowness.h"
#include "tests/uvs/flat_mesh.h"

namespace atlas::test {
namespace {

constexpr double kStep = 0x1p-24;  // between floats just below 1

Buckets corners_at(const std::vector<std::uint32_t>& corners, std::size_t uvs) {
  return sort_into_buckets(corners.size(), uvs, [&](std::size_t c) { return corners[c]; });
}

// Counts triangles that are closed or turned over, in whole steps.
std::size_t not_open(const std::vector<std::uint32_t>& corners, const std::vector<Vec2f>& uvs) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const auto x = [&](std::size_t k) { return std::llround(uvs[corners[t + k]].x / kStep * 4); };
    const auto y = [&](std::size_t k) { return std::llround(uvs[corners[t + k]].y / kStep * 4); };
    count += (x(1) - x(0)) * (y(2) - y(0)) - (y(1) - y(0)) * (x(2) - x(0)) <= 0;
  }
  return count;
}

// The slivers are open but for one. Moves of less than a step help nothing, and the exact uvs are
// worse when they are rounded.
TEST(OpenStacks, MovesThatDoNotHelpAreNotMade) {
  const FlatMesh mesh = stack_of_slivers(3, 6, 0, 1e-9);
  std::vector<Vec2f> uvs;
  ASSERT_EQ(round_uvs(mesh.uvs, mesh.corners, uvs), 0u);
  const std::uint32_t* c = &mesh.corners[3 * (2 * 6 + 4)];  // of the row in the middle
  uvs[c[2]] = {(uvs[c[0]].x + uvs[c[1]].x) / 2, uvs[c[0]].y};
  const std::vector<Vec2f> before = uvs;
  ASSERT_GT(not_open(mesh.corners, uvs), 0u);
  std::vector<glm::dvec2> exact;
  for (const Vec2d& p : mesh.uvs) exact.push_back({p.x, p.y});
  open_stacks({mesh.corners, corners_at(mesh.corners, uvs.size()), exact}, 0.1 * kStep, uvs);
  EXPECT_EQ(uvs, before);
}

// Four uvs in one place within a ring, most of whose corners lie to the right of them. The largest
// circles would carry the first uv, which is joined to these, through the ring. A triangle that is
// given both ways round keeps the cluster from ever being open.
TEST(SpreadSpecks, TheBestOfAllCirclesIsKept) {
  std::vector<Vec2f> uvs(4, Vec2f{0.5F, 0.5F});
  std::vector<double> degrees;
  for (int k = 0; k <= 12; ++k) degrees.push_back(-20 + 40.0 * k / 12);
  degrees.insert(degrees.end(), {60, 110, 160, 200, 250, 300});
  for (const double d : degrees)
    uvs.push_back({float(0.5 + 400 * kStep * std::cos(d * M_PI / 180)),
                   float(0.5 + 400 * kStep * std::sin(d * M_PI / 180))});
  const std::uint32_t first[] = {0, 12, 14, 16, 19};  // of each member's part of the ring
  const auto ring = [](std::uint32_t k) { return 4 + k % 19; };
  std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 3, 0, 2, 1};
  for (std::uint32_t member = 0; member < 4; ++member) {
    for (std::uint32_t k = first[member]; k < first[member + 1]; ++k)
      corners.insert(corners.end(), {member, ring(k), ring(k + 1)});
    corners.insert(corners.end(), {member, ring(first[member + 1]), (member + 1) % 4});
  }
  const std::size_t before = not_open(corners, uvs);
  ASSERT_EQ(before, 7u);
  spread_specks(corners, corners_at(corners, uvs.size()), uvs);
  EXPECT_EQ(not_open(corners, uvs), 1u);
}

// Expects the first uvs to lie on the smallest circle that leaves no triangle thin, of those of 8
// steps per root of their number, twice as much, and so on.
void expect_smallest_circle(std::span<const std::uint32_t> corners, std::span<const Vec2f> uvs,
                            std::uint32_t members, double radius) {
  const auto thin_at = [&](double share) {
    std::vector<Vec2f> scaled(uvs.begin(), uvs.end());
    for (std::uint32_t i = 0; i < members; ++i)
      scaled[i] = {float(0.5 + share * (uvs[i].x - 0.5)), float(0.5 + share * (uvs[i].y - 0.5))};
    std::size_t count = 0;
    for (std::size_t t = 0; t < corners.size(); t += 3)
      count += is_thin(corners.subspan(t).first<3>(), scaled);
    return count;
  };
  EXPECT_EQ(thin_at(1), 0u);
  if (radius > 1.1 * 8 * std::sqrt(members) * kStep) {
    EXPECT_GT(thin_at(0.5), 0u) << radius / kStep;
  }
}

// Uvs in one place, with a ring of `n` around them. Each member is joined to an equal part of the
// ring, and to the members before and after it.
struct Speck {
  std::vector<Vec2f> uvs;
  std::vector<std::uint32_t> corners;
};
Speck speck_in_ring(std::uint32_t members, std::uint32_t n) {
  Speck speck;
  speck.uvs.assign(members, Vec2f{0.5F, 0.5F});
  for (std::uint32_t k = 0; k < n; ++k) {
    const double angle = 2 * M_PI * k / n;
    speck.uvs.push_back({float(0.5 + 0.1 * std::cos(angle)), float(0.5 + 0.1 * std::sin(angle))});
  }
  for (std::uint32_t i = 0; i < members; ++i) {
    const std::uint32_t begin = i * n / members, end = (i + 1) * n / members;
    for (std::uint32_t k = begin; k < end; ++k)
      speck.corners.insert(speck.corners.end(), {i, members + k, members + (k + 1) % n});
    speck.corners.insert(speck.corners.end(), {i, members + end % n, (i + 1) % members});
  }
  for (std::uint32_t i = 2; i < members; ++i)
    speck.corners.insert(speck.corners.end(), {0, i - 1, i});
  return speck;
}

// The ring counts as points of a circle in its directions. Where each member is the mean of its
// neighbours follows from these by one linear equation per member.
TEST(SpreadSpecks, EachUvIsAmidItsNeighbours) {
  for (const std::uint32_t members : {2u, 3u, 4u, 6u}) {
    SCOPED_TRACE(members);
    Speck speck = speck_in_ring(members, 12);
    ASSERT_GT(not_open(speck.corners, speck.uvs), 0u);
    spread_specks(speck.corners, corners_at(speck.corners, speck.uvs.size()), speck.uvs);
    EXPECT_EQ(not_open(speck.corners, speck.uvs), 0u);
    // Neighbours once each, and what their circle has for a radius.
    std::vector<std::set<std::uint32_t>> around(members);
    for (std::size_t c = 0; c < speck.corners.size(); ++c) {
      const std::size_t t = c / 3 * 3;
      if (speck.corners[c] >= members) continue;
      around[speck.corners[c]].insert(speck.corners[t + (c + 1) % 3]);
      around[speck.corners[c]].insert(speck.corners[t + (c + 2) % 3]);
    }
    double above = 0, below = 0;  // least squares: radius * outer = count * p - inner
    std::vector<std::array<Vec2d, 2>> sides;
    for (std::uint32_t i = 0; i < members; ++i) {
      Vec2d inner{0, 0}, outer{0, 0};
      for (const std::uint32_t other : around[i]) {
        const Vec2d d{speck.uvs[other].x - 0.5, speck.uvs[other].y - 0.5};
        const double length = other < members ? 1 : std::hypot(d.x, d.y);
        Vec2d& sum = other < members ? inner : outer;
        sum = {sum.x + d.x / length, sum.y + d.y / length};
      }
      const double count = double(around[i].size());
      sides.push_back({Vec2d{count * (speck.uvs[i].x - 0.5) - inner.x,
                             count * (speck.uvs[i].y - 0.5) - inner.y},
                       outer});
      above += sides[i][0].x * outer.x + sides[i][0].y * outer.y;
      below += outer.x * outer.x + outer.y * outer.y;
    }
    const double radius = above / below;
    expect_smallest_circle(speck.corners, speck.uvs, members, radius);
    for (const auto& [moved, outer] : sides) {
      EXPECT_NEAR(moved.x, radius * outer.x, 8 * kStep);
      EXPECT_NEAR(moved.y, radius * outer.y, 8 * kStep);
    }
  }
}

// Three uvs on the mesh's border and one inside, in one place below half a ring. Those of the
// border lie on the circle, and the one inside is amid all others.
TEST(SpreadSpecks, UvsOfTheBorderLieOnTheCircle) {
  constexpr std::uint32_t kParts = 7, kFirst = 4;
  enum : std::uint32_t { left, middle, right, inside };
  std::vector<Vec2f> uvs(4, Vec2f{0.5F, 0.5F});
  std::vector<Vec2d> direction;
  for (std::uint32_t k = 0; k <= kParts; ++k) {
    direction.push_back({std::cos(M_PI * k / kParts), std::sin(M_PI * k / kParts)});
    uvs.push_back({float(0.5 + 0.1 * direction[k].x), float(0.5 + 0.1 * direction[k].y)});
  }
  constexpr std::uint32_t last = kFirst + kParts;
  std::vector<std::uint32_t> corners{left,  middle,   inside,     middle, right,      inside,
                                     right, kFirst,   kFirst + 1, right,  kFirst + 1, inside,
                                     left,  last - 1, last,       inside, last - 1,   left};
  for (std::uint32_t k = 1; k + 1 < kParts; ++k)
    corners.insert(corners.end(), {inside, kFirst + k, kFirst + k + 1});
  spread_specks(corners, corners_at(corners, uvs.size()), uvs);
  EXPECT_EQ(not_open(corners, uvs), 0u);
  const auto off = [&](std::uint32_t i) { return Vec2d{uvs[i].x - 0.5, uvs[i].y - 0.5}; };
  const double radius = std::hypot(off(middle).x, off(middle).y);
  expect_smallest_circle(corners, uvs, 4, radius);
  Vec2d sum{0, 0};
  for (const std::uint32_t i : {left, middle, right}) {
    // In equal parts of the half turn that is free of the mesh.
    const double angle = M_PI * (1 + (i + 1) / 4.0);
    EXPECT_NEAR(off(i).x, radius * std::cos(angle), kStep);
    EXPECT_NEAR(off(i).y, radius * std::sin(angle), kStep);
    sum = {sum.x + off(i).x, sum.y + off(i).y};
  }
  for (std::uint32_t k = 1; k < kParts; ++k)
    sum = {sum.x + radius * direction[k].x, sum.y + radius * direction[k].y};
  EXPECT_NEAR(off(inside).x, sum.x / (3 + kParts - 1), kStep);
  EXPECT_NEAR(off(inside).y, sum.y / (3 + kParts - 1), kStep);
}

// Large specks are left as they are: to place each of their uvs amid its neighbours takes time that
// grows with the square of their number.
TEST(SpreadSpecks, LargeSpecksEndSoon) {
  constexpr std::uint32_t kSide = 60, kSpecks = 40;
  std::vector<Vec2f> uvs;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t speck = 0; speck < kSpecks; ++speck) {
    const auto first = std::uint32_t(uvs.size());
    uvs.insert(uvs.end(), (kSide + 1) * (kSide + 1),
               Vec2f{0.25F + 0.5F * float(speck) / kSpecks, 0.5F});
    for (std::uint32_t y = 0; y < kSide; ++y) {
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const std::uint32_t a = first + y * (kSide + 1) + x, b = a + 1, d = a + kSide + 1,
                            e = d + 1;
        corners.insert(corners.end(), {a, b, d, b, e, d});
      }
    }
  }
  const std::vector<Vec2f> before = uvs;
  const double begun = cpu_seconds();
  spread_specks(corners, corners_at(corners, uvs.size()), uvs);
  EXPECT_LT(cpu_seconds() - begun, 5 * kSlowness);
  EXPECT_EQ(uvs, before);
}

}  // namespace
}  // namespace atlas::test
