// Opening stacks and spreading specks leaves no more thin triangles than there were, and takes
// bounded time.
#include "libatlas/uvs/spread_specks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
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
