// Rounding uvs to floats leaves every triangle positive, for readers that use floats or doubles.
#include "libatlas/uvs/round_uvs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "libatlas/uvs/open_stacks.h"
#include "libatlas/uvs/push_slivers.h"
#include "libatlas/uvs/thin_uvs.h"
#include "tests/support/flat_mesh.h"

namespace atlas::test {
namespace {

// Reads a float back as from a text file: its shortest decimals, parsed as a double.
double read_back(float value) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return std::strtod(std::string(text, end).c_str(), nullptr);
}

template <class Number, class Read>
std::size_t not_positive(const FlatMesh& mesh, const std::vector<Vec2f>& uvs, Read read) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
    const std::uint32_t* c = &mesh.corners[t];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    const auto x = [&](int k) { return Number(read(uvs[c[k]].x)); };
    const auto y = [&](int k) { return Number(read(uvs[c[k]].y)); };
    count += !((x(1) - x(0)) * (y(2) - y(0)) - (y(1) - y(0)) * (x(2) - x(0)) > 0);
  }
  return count;
}

std::size_t in_integers(const FlatMesh& mesh, const std::vector<Vec2f>& uvs) {
  // Floats from 1/4 to 1 are multiples of 2^-26, and products of two stay below 2^52.
  return not_positive<std::int64_t>(mesh, uvs,
                                    [](float v) { return std::int64_t(std::ldexp(v, 26)); });
}

std::vector<FlatMesh> hard_meshes() {
  std::vector<FlatMesh> meshes;
  for (const double slope : {0.0, 0.3, 0.785398, 1.2, 1.570796}) {
    for (const double height : {1e-7, 1e-9, 1e-12}) {
      for (const int rows : {3, 5, 8}) {
        meshes.push_back(stack_of_slivers(rows, 6, slope, height));
      }
    }
  }
  return meshes;
}

TEST(RoundUvs, SliversStayOpen) {
  std::size_t turned = 0;
  for (const FlatMesh& mesh : hard_meshes()) {
    std::vector<Vec2f> plain;
    for (const Vec2d& p : mesh.uvs) plain.push_back({float(p.x), float(p.y)});
    turned += in_integers(mesh, plain);
    std::vector<Vec2f> rounded;
    EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 0u) << mesh.name;
    EXPECT_EQ(in_integers(mesh, rounded), 0u);
    EXPECT_EQ(not_positive<double>(mesh, rounded, read_back), 0u);
    EXPECT_EQ(not_positive<double>(mesh, rounded, [](float v) { return v * 1983.0f; }), 0u);
    for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
      const double off = std::hypot(rounded[i].x - mesh.uvs[i].x, rounded[i].y - mesh.uvs[i].y);
      EXPECT_LT(off, 2e-5) << "a twenty-fifth of a texel of 2048";
    }
  }
  EXPECT_GT(turned, 100u) << "the test is too easy";
}

// A uv on the diagonal of a square, at various places and angles.
TEST(RoundUvs, ASliverByItselfMovesByAFewSteps) {
  for (double angle = 0; angle < 1.6; angle += 0.1) {
    for (const double along : {0.001, 0.1, 0.5, 0.83}) {
      FlatMesh mesh;
      const double c = 0.4 * std::cos(angle), s = 0.4 * std::sin(angle);
      mesh.uvs = {{0.5 - c, 0.5 - s}, {0.5 + s, 0.5 - c}, {0.5 + c, 0.5 + s}, {0.5 - s, 0.5 + c}};
      const Vec2d a = mesh.uvs[0], b = mesh.uvs[2];
      mesh.uvs.push_back(
          {a.x + along * (b.x - a.x) - 1e-9 * s, a.y + along * (b.y - a.y) + 1e-9 * c});
      mesh.corners = {0, 1, 2, 0, 2, 4, 2, 3, 4, 3, 0, 4};
      std::vector<Vec2f> rounded;
      EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 0u);
      for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
        const double off = std::hypot(rounded[i].x - mesh.uvs[i].x, rounded[i].y - mesh.uvs[i].y);
        EXPECT_LT(off, 3.5 * 0x1p-24) << angle << ' ' << along;
      }
    }
  }
}

TEST(RoundUvs, SliversThatLeanOnEachOtherAreOpened) {
  const FlatMesh mesh = leaning_slivers();
  std::vector<Vec2f> rounded;
  EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 0u);
  EXPECT_EQ(in_integers(mesh, rounded), 0u);
  EXPECT_EQ(not_positive<double>(mesh, rounded, read_back), 0u);
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    EXPECT_LT(std::hypot(rounded[i].x - mesh.uvs[i].x, rounded[i].y - mesh.uvs[i].y), 5e-4);
  }
}

// A needle lies between slivers that are open, but cannot move unless their own far corners move.
TEST(OpenStacks, WhatIsHemmedInMovesItsNeighbours) {
  const double step = 0x1p-24, length = 0.125, open = 3.2 * step;
  const std::vector<glm::dvec2> exact{{0.5, 0.5},
                                      {0.5 + length, 0.5},
                                      {0.5 + length / 2, 0.5 + 0.1 * step},
                                      {0.5 + length / 2, 0.5 - open},
                                      {0.5 + length / 2, 0.5 + 0.1 * step + open},
                                      {0.5 + length / 2, 0.3},
                                      {0.5 + length / 2, 0.7}};
  const std::vector<std::uint32_t> corners{0, 1, 2, 0, 3, 1, 2, 1, 4, 0, 2, 4,
                                           0, 5, 3, 3, 5, 1, 4, 1, 6, 0, 4, 6};
  const auto triangle = [&](std::uint32_t t) {
    return std::span(corners).subspan(3 * std::size_t(t)).first<3>();
  };
  std::vector<Vec2f> uvs;
  for (const glm::dvec2& p : exact) uvs.push_back(rounded_uv(p));
  ASSERT_TRUE(is_thin(triangle(0), uvs));
  const Buckets corners_at =
      sort_into_buckets(corners.size(), uvs.size(), [&](std::size_t c) { return corners[c]; });
  open_stacks({corners, corners_at, exact}, 1, uvs);
  for (std::uint32_t t = 0; t < corners.size() / 3; ++t) {
    EXPECT_FALSE(is_thin(triangle(t), uvs)) << t;
  }
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
  ASSERT_GT(in_integers(mesh, uvs), 0u);
  std::vector<glm::dvec2> exact;
  for (const Vec2d& p : mesh.uvs) exact.push_back({p.x, p.y});
  const Buckets corners_at = sort_into_buckets(mesh.corners.size(), uvs.size(),
                                               [&](std::size_t i) { return mesh.corners[i]; });
  open_stacks({mesh.corners, corners_at, exact}, 0.1 * kUvStep, uvs);
  EXPECT_EQ(uvs, before);
}

// Fans of slivers on both sides of a line that is straight except for less than a float's last
// place.
TEST(RoundUvs, FansOfManySliversAreOpened) {
  FlatMesh mesh;
  constexpr int n = 100;
  mesh.uvs = {{0.3, 0.5}, {0.3, 0.9}};
  double x = 0.55;
  for (int i = 0; i <= n; ++i) {
    mesh.uvs.push_back({x, 0.5 + 1e-12 * i * i});
    x += i % 3 == 0 ? 3e-5 : 2e-6;
  }
  for (std::uint32_t i = 2; i < n + 2; ++i) {
    mesh.corners.insert(mesh.corners.end(), {0, i + 1, i, 1, i, i + 1});
  }
  for (std::size_t t = 0; t < mesh.corners.size(); t += 6)
    std::swap(mesh.corners[t + 1], mesh.corners[t + 2]);
  std::vector<Vec2f> rounded;
  EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 0u);
  EXPECT_EQ(in_integers(mesh, rounded), 0u);
}

// These pages are baked already: however large the page, uvs stay within a texel.
TEST(RoundUvs, NoCornerGoesFartherThanAsked) {
  double moved = 0;
  for (const FlatMesh& mesh : {stack_of_slivers(100, 6, 0.3, 1e-9), leaning_slivers()}) {
    for (const double farthest : {1.0, 1.0 / 4096, 1.0 / 16384, 1.0 / 65536}) {
      std::vector<Vec2f> rounded;
      const std::size_t left = round_uvs(mesh.uvs, mesh.corners, rounded, farthest);
      EXPECT_LE(in_integers(mesh, rounded), left);
      double most = 0;
      for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
        most = std::max({most, std::fabs(rounded[i].x - mesh.uvs[i].x),
                         std::fabs(rounded[i].y - mesh.uvs[i].y)});
      }
      EXPECT_LE(most, farthest + 0x1p-24);
      moved = std::max(moved, most);
    }
  }
  EXPECT_GT(moved, 1.5 / 16384) << "the test is too easy";
}

TEST(RoundUvs, SpecksKeepAnArea) {
  // A square of 1e-8 within one of 0.5.
  FlatMesh mesh;
  mesh.uvs = {{0.3, 0.3}, {0.8, 0.3}, {0.8, 0.8}, {0.3, 0.8}};
  for (const Vec2d p : {Vec2d{0, 0}, {1e-8, 0}, {1e-8, 1e-8}, {0, 1e-8}}) {
    mesh.uvs.push_back({0.51 + p.x, 0.53 + p.y});
  }
  mesh.corners = {0, 1, 4, 1, 5, 4, 1, 2, 5, 2, 6, 5, 2, 3, 6,
                  3, 7, 6, 3, 0, 7, 0, 4, 7, 4, 5, 6, 4, 6, 7};
  std::vector<Vec2f> rounded;
  EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 0u);
  EXPECT_EQ(in_integers(mesh, rounded), 0u);
  const double twice =
      (double(rounded[5].x) - rounded[4].x) * (double(rounded[6].y) - rounded[4].y) -
      (double(rounded[5].y) - rounded[4].y) * (double(rounded[6].x) - rounded[4].x);
  EXPECT_GT(twice / 2, 1e-12);
}

// A grid whose points closer to `around` than `reach` columns are contracted there; with size 0
// into one point.
FlatMesh speck_in_grid(int n, Vec2d around, double reach, double size) {
  FlatMesh mesh;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  const double step = 0.5 / n;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const bool edge = x == 0 || y == 0 || x == n || y == n;
      Vec2d p{0.3 + step * (x + (edge ? 0 : jitter(random))),
              0.3 + step * (y + (edge ? 0 : jitter(random)))};
      const double dx = p.x - around.x, dy = p.y - around.y;
      if (std::hypot(dx, dy) < reach * step) {
        p = {around.x + size * dx / step, around.y + size * dy / step};
      }
      mesh.uvs.push_back(p);
    }
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const auto a = std::uint32_t(y * (n + 1) + x), b = a + 1, d = a + std::uint32_t(n) + 1,
                 e = d + 1;
      mesh.corners.insert(mesh.corners.end(), {a, b, d, b, e, d});
    }
  }
  return mesh;
}

void expect_spread(const FlatMesh& mesh, double most) {
  std::vector<Vec2f> plain, rounded;
  for (const Vec2d& p : mesh.uvs) plain.push_back({float(p.x), float(p.y)});
  EXPECT_GT(in_integers(mesh, plain), 0u) << "the test is too easy";
  EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 0u);
  EXPECT_EQ(in_integers(mesh, rounded), 0u);
  EXPECT_EQ(not_positive<double>(mesh, rounded, read_back), 0u);
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    EXPECT_LT(std::hypot(rounded[i].x - mesh.uvs[i].x, rounded[i].y - mesh.uvs[i].y), most);
  }
}

TEST(RoundUvs, SpecksInOnePointAreSpread) {
  for (const double size : {0.0, 1e-10, 1e-8}) {
    for (const double reach : {1.4, 2.5}) {
      for (const Vec2d around : {Vec2d{0.55, 0.55},  // inside
                                 Vec2d{0.3, 0.52},   // at a side
                                 Vec2d{0.8, 0.8}}) {
        SCOPED_TRACE(::testing::Message()
                     << size << " " << reach << " at " << around.x << ", " << around.y);
        expect_spread(speck_in_grid(10, around, reach, size), 4e-5);
      }
    }
  }
}

TEST(RoundUvs, APieceThatIsASpeckIsSpread) {
  for (const double size : {1e-14, 1e-9})
    expect_spread(speck_in_grid(3, {0.55, 0.55}, 9, size), 4e-5);
}

// Where the mesh is open up to the contracted points, its border passes there twice. Such points
// are left to the other methods.
TEST(RoundUvs, SpecksThatPinchTheBorderEnd) {
  FlatMesh mesh = speck_in_grid(6, {0.55, 0.55}, 1.4, 1e-9);
  const std::vector<std::uint32_t> all = std::move(mesh.corners);
  for (std::size_t t = 0; t < all.size(); t += 3) {  // two opposite corners of the grid are removed
    const bool low = all[t] % 7 < 3 && all[t] / 7 < 3, high = all[t] % 7 > 3 && all[t] / 7 > 3;
    if (!low && !high) mesh.corners.insert(mesh.corners.end(), &all[t], &all[t] + 3);
  }
  std::vector<Vec2f> rounded;
  const std::size_t left = round_uvs(mesh.uvs, mesh.corners, rounded);
  EXPECT_LE(in_integers(mesh, rounded), left);
}

// The same triangles in the order in which round_uvs() takes them. How many stay thin depends on
// the order.
FlatMesh in_order(FlatMesh mesh) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t c = 0; c < mesh.corners.size(); c += 3) {
    std::array<std::uint32_t, 3> t{mesh.corners[c], mesh.corners[c + 1], mesh.corners[c + 2]};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    triangles.push_back(t);
  }
  std::sort(triangles.begin(), triangles.end());
  mesh.corners.clear();
  for (const auto& t : triangles) mesh.corners.insert(mesh.corners.end(), t.begin(), t.end());
  return mesh;
}

// Where corners may hardly move, many slivers stay thin. Pushing them on from there closes more of
// some stacks than it opens, and opens more of others.
TEST(RoundUvs, PushingOnNeverClosesMore) {
  constexpr double kFarthest = 3e-7;
  std::size_t all = 0, all_before = 0;
  for (const double slope : {0.0, 0.3, 0.785398}) {
    for (const double height : {1e-8, 1e-9, 1e-12}) {
      const FlatMesh mesh = in_order(stack_of_slivers(8, 20, slope, height));
      const Buckets corners_at = sort_into_buckets(mesh.corners.size(), mesh.uvs.size(),
                                                   [&](std::size_t i) { return mesh.corners[i]; });
      std::vector<glm::dvec2> exact;
      std::vector<Vec2f> uvs, rounded;
      for (const Vec2d& p : mesh.uvs) {
        exact.push_back(to_glm(p));
        uvs.push_back(rounded_uv(exact.back()));
      }
      push_slivers({mesh.corners, corners_at, exact}, mesh.uvs, kFarthest, uvs);
      open_stacks({mesh.corners, corners_at, exact}, kFarthest, uvs);
      std::size_t before = 0;
      for (std::size_t c = 0; c < mesh.corners.size(); c += 3)
        before += is_thin(std::span(mesh.corners).subspan(c).first<3>(), uvs);
      const std::size_t left = round_uvs(mesh.uvs, mesh.corners, rounded, kFarthest);
      EXPECT_LE(left, before) << mesh.name;
      all += left;
      all_before += before;
    }
  }
  EXPECT_LT(all, all_before);
}

TEST(RoundUvs, WhatIsOpenIsRoundedToTheNearest) {
  const FlatMesh mesh = stack_of_slivers(2, 50, 0.4, 1e-3);
  std::vector<Vec2f> rounded;
  EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 0u);
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    EXPECT_EQ(rounded[i], (Vec2f{float(mesh.uvs[i].x), float(mesh.uvs[i].y)}));
  }
}

TEST(RoundUvs, PointsLinesAndWhatCannotBeOpenedEnd) {
  FlatMesh mesh = stack_of_slivers(3, 4, 0.2, 1e-9);
  mesh.corners.insert(mesh.corners.end(), {0, 0, 1, 2, 2, 2});  // without area
  mesh.corners.insert(mesh.corners.end(), {mesh.corners[0], mesh.corners[2], mesh.corners[1]});
  std::vector<Vec2f> rounded;
  EXPECT_EQ(round_uvs(mesh.uvs, mesh.corners, rounded), 1u);
  EXPECT_EQ(in_integers(mesh, rounded), 1u);
}

}  // namespace
}  // namespace atlas::test
