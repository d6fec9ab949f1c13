// Pushing slivers open, and opening stacks of them, takes work in proportion to the mesh.
#include "libatlas/uvs/push_slivers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/uvs/thin_uvs.h"
#include "tests/support/flat_mesh.h"

namespace atlas::test {
namespace {

// A disc of triangles around one uv. Every third one is a sliver.
FlatMesh fan(std::uint32_t n) {
  FlatMesh mesh;
  mesh.uvs.push_back({0.5, 0.5});
  const double whole = 2 * M_PI / (2 * (n / 3) + 1e-6);
  double angle = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    mesh.uvs.push_back({0.5 + 0.4 * std::cos(angle), 0.5 + 0.4 * std::sin(angle)});
    mesh.corners.insert(mesh.corners.end(), {0, 1 + i, 1 + (i + 1) % n});
    angle += i % 3 == 0 ? 1e-9 : whole;
  }
  return mesh;
}

struct Input {
  explicit Input(const FlatMesh& mesh)
      : corners_at(sort_into_buckets(mesh.corners.size(), mesh.uvs.size(),
                                     [&](std::size_t c) { return mesh.corners[c]; })) {
    for (const Vec2d& p : mesh.uvs) {
      exact.push_back(to_glm(p));
      uvs.push_back(rounded_uv(to_glm(p)));
    }
  }

  Buckets corners_at;
  std::vector<glm::dvec2> exact;
  std::vector<Vec2f> uvs;
};

std::size_t count_thin(const FlatMesh& mesh, const std::vector<Vec2f>& uvs) {
  const std::span<const std::uint32_t> corners = mesh.corners;
  std::size_t count = 0;
  for (std::size_t t = 0; t < corners.size(); t += 3)
    count += is_thin(corners.subspan(t).first<3>(), uvs);
  return count;
}

// Each push moves the uv in the middle, and with it all triangles, but hardly.
TEST(PushSlivers, FansTakeWorkInProportionToTheirTriangles) {
  for (const std::uint32_t n : {300u, 3000u, 30000u}) {
    SCOPED_TRACE(n);
    const FlatMesh mesh = fan(n);
    Input input(mesh);
    EXPECT_GT(count_thin(mesh, input.uvs), n / 4);
    const PushWork work =
        push_slivers({mesh.corners, input.corners_at, input.exact}, mesh.uvs, 1, input.uvs);
    EXPECT_EQ(count_thin(mesh, input.uvs), 0u);
    EXPECT_GE(work.pushes, n / 4);
    EXPECT_LE(work.pushes, 2 * n);
    EXPECT_LE(work.looks, 100 * std::size_t(n));
  }
}

// A fan of `spokes` around the first uv. Beside its first and its middle spoke, a uv near the hub
// makes a sliver with that spoke: one without height, and one that is just open.
FlatMesh fan_with_two_slivers(std::uint32_t spokes, double open_by) {
  FlatMesh mesh;
  mesh.uvs.push_back({0.5, 0.5});
  for (std::uint32_t i = 0; i < spokes; ++i) {
    const double angle = 2 * M_PI * i / spokes;
    const double y = 2 * i == spokes ? 0 : std::sin(angle);
    mesh.uvs.push_back({0.5 + 0.3 * std::cos(angle), 0.5 + 0.3 * y});
  }
  mesh.uvs.push_back({0.501, 0.5});
  mesh.uvs.push_back({0.499, 0.5 - open_by * 0x1p-24});
  for (std::uint32_t i = 0; i < spokes; ++i) {
    const std::uint32_t p = 1 + i, next = 1 + (i + 1) % spokes;
    if (2 * i % spokes != 0) {
      mesh.corners.insert(mesh.corners.end(), {0, p, next});
      continue;
    }
    const std::uint32_t q = 1 + spokes + (i > 0);
    mesh.corners.insert(mesh.corners.end(), {0, p, q, p, next, q, 0, q, next});
  }
  return mesh;
}

// Pushing the first sliver open moves the uv in the middle, by half of what a sliver needs. This
// closes the second one, at a uv of few triangles and at a hub of many.
TEST(PushSlivers, WhatAPushClosesIsPushedInTurn) {
  for (const std::uint32_t spokes : {20u, 80u, 400u}) {
    for (const double open_by : {3.2, 4.0, 100.0}) {
      SCOPED_TRACE(::testing::Message() << spokes << ' ' << open_by);
      const FlatMesh mesh = fan_with_two_slivers(spokes, open_by);
      Input input(mesh);
      ASSERT_EQ(count_thin(mesh, input.uvs), 1u);
      const PushWork work =
          push_slivers({mesh.corners, input.corners_at, input.exact}, mesh.uvs, 1, input.uvs);
      EXPECT_EQ(count_thin(mesh, input.uvs), 0u);
      EXPECT_GE(work.pushes, 1u);
    }
  }
}

// Where a whole fan is smaller than the step between floats, each push closes all of its triangles.
TEST(PushSlivers, TinyFansTakeLimitedWork) {
  constexpr std::uint32_t kCount = 9000;
  FlatMesh mesh;
  mesh.uvs.push_back({0.5, 0.5});
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double angle = 2 * M_PI * i / kCount;
    mesh.uvs.push_back({0.5 + 1e-7 * std::cos(angle), 0.5 + 1e-7 * std::sin(angle)});
    mesh.corners.insert(mesh.corners.end(), {0, 1 + i, 1 + (i + 1) % kCount});
  }
  Input input(mesh);
  const PushWork work =
      push_slivers({mesh.corners, input.corners_at, input.exact}, mesh.uvs, 1, input.uvs);
  EXPECT_LE(work.looks, 2400 * std::size_t(kCount));
}

TEST(OpenStacks, EachStackIsAnalysedOnce) {
  const FlatMesh mesh = leaning_slivers();
  Input input(mesh);
  ASSERT_GT(count_thin(mesh, input.uvs), 0u);
  const StackWork work = open_stacks({mesh.corners, input.corners_at, input.exact}, 1, input.uvs);
  EXPECT_EQ(count_thin(mesh, input.uvs), 0u);
  EXPECT_GE(work.solves, 20u) << "the test is too easy";
  EXPECT_LE(work.patterns, 4u) << "one, and one for each ring around it";
}

}  // namespace
}  // namespace atlas::test
