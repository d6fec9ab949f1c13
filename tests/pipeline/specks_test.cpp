// Opening stacks and spreading specks leaves no more thin triangles than there were, and takes
// bounded time.
#include "libatlas/pipeline/spread_specks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/pipeline/open_stacks.h"
#include "libatlas/pipeline/round_uvs.h"
#include "libatlas/pipeline/thin_uvs.h"
#include "tests/pipeline/flat_mesh.h"

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

// A fan whose hub is a cluster of two uvs, within a ring so narrow that the larger circles for the
// cluster turn the fan's triangles over. A triangle that is given both ways round keeps the cluster
// from ever being open.
TEST(SpreadSpecks, TheBestOfAllCirclesIsKept) {
  constexpr std::uint32_t kRim = 12;
  for (const double radius : {20.0, 24.0, 28.0}) {
    std::vector<Vec2f> uvs{{0.5F, 0.5F}, {0.5F, 0.5F}};
    for (std::uint32_t k = 0; k < kRim; ++k) {
      const double angle = 2 * M_PI * k / kRim;
      uvs.push_back({float(0.5 + radius * kStep * std::cos(angle)),
                     float(0.5 + radius * kStep * std::sin(angle))});
    }
    std::vector<std::uint32_t> corners;
    for (std::uint32_t k = 0; k < kRim; ++k) {
      const std::uint32_t hub = k < kRim / 2 ? 0 : 1, next = (k + 1) % kRim;
      corners.insert(corners.end(), {hub, 2 + k, 2 + next});
    }
    corners.insert(corners.end(), {0, 2 + kRim / 2, 1, 1, 2, 0, 0, 2, 1});
    const std::size_t before = not_open(corners, uvs);
    ASSERT_GT(before, 0u);
    spread_specks(corners, corners_at(corners, uvs.size()), uvs);
    EXPECT_LE(not_open(corners, uvs), before) << radius;
  }
}

// A large speck is left as it is: to place each of its uvs amid its neighbours would take hours.
TEST(SpreadSpecks, LargeSpecksEndSoon) {
  constexpr std::uint32_t kSide = 200;
  std::vector<Vec2f> uvs((kSide + 1) * (kSide + 1), Vec2f{0.5F, 0.5F});
  std::vector<std::uint32_t> corners;
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t a = y * (kSide + 1) + x, b = a + 1, d = a + kSide + 1, e = d + 1;
      corners.insert(corners.end(), {a, b, d, b, e, d});
    }
  }
  const std::vector<Vec2f> before = uvs;
  const double begun = cpu_seconds();
  spread_specks(corners, corners_at(corners, uvs.size()), uvs);
  EXPECT_LT(cpu_seconds() - begun, 10);
  EXPECT_EQ(uvs, before);
}

}  // namespace
}  // namespace atlas::test
