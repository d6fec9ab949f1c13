// The origin that positions are stored relative to.
#include "libatlas/scene/building/frame.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

constexpr int kFrameSide = 21;
constexpr double kStep = 0.25;

// Returns an OBJ of a bent sheet near the point, with `rest` behind its vertices and faces.
std::string sheet(const Vec3d& at, const std::string& rest) {
  std::string text;
  for (int y = 0; y < kFrameSide; ++y)
    for (int x = 0; x < kFrameSide; ++x)
      text +=
          fmt::format("v {} {} {}\n", at.x + kStep * x, at.y + kStep * y, at.z + std::sin(0.3 * y));
  for (int y = 0; y + 1 < kFrameSide; ++y) {
    for (int x = 0; x + 1 < kFrameSide; ++x) {
      const int v = 1 + y * kFrameSide + x;
      text += fmt::format("f {} {} {}\nf {} {} {}\n", v, v + 1, v + kFrameSide, v + 1,
                          v + kFrameSide + 1, v + kFrameSide);
    }
  }
  return text + rest;
}

LoadedScene load(const TempFolder& folder, const std::string& text) {
  auto loaded = read_scene(folder.write("scene.obj", text), {}, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  return std::move(*loaded);
}

// Expects the sheet's grid to be exact.
void expect_exact(const LoadedScene& loaded, const Vec3d& at) {
  const Vec3d& origin = loaded.scene.origin;
  for (int i = 0; i < kFrameSide * kFrameSide; ++i) {
    const Vec3f& p = loaded.scene.positions[i];
    ASSERT_EQ(origin.x + p.x, at.x + kStep * (i % kFrameSide)) << i;
    ASSERT_EQ(origin.y + p.y, at.y + kStep * (i / kFrameSide)) << i;
  }
}

const std::string kSpeck = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf -3 -2 -1\n";

TEST(Frame, AStrayTriangleDoesNotRoundTheScene) {
  const TempFolder folder;
  const Vec3d at{500000, 4.6e6, 120};
  for (const std::string& stray : {kSpeck, std::string("v 0 0 0\nf -1 1 2\n")}) {
    const LoadedScene loaded = load(folder, sheet(at, stray));
    expect_exact(loaded, at);
    EXPECT_LE(loaded.defects.count(DefectKind::position_rounded), 3u);
    const double y = loaded.scene.origin.y;
    EXPECT_EQ(y, std::round(y / 0.25) * 0.25);
  }
}

// Farther out than floats of the whole extent could hold even the sheet's place.
TEST(Frame, StrayTrianglesMayLieAnywhere) {
  const TempFolder folder;
  for (const char* far : {"1e9", "-1e20", "1e30"}) {
    const std::string rest = fmt::format("v {0} 0 0\nv {0} 1 0\nv {0} 0 {0}\nf -3 -2 -1\n", far);
    expect_exact(load(folder, sheet({3, 4, 5}, rest)), {3, 4, 5});
  }
}

TEST(Frame, ExactScenesKeepTheirOrigin) {
  const TempFolder folder;
  const LoadedScene near = load(folder, sheet({0, 0, 0}, ""));
  EXPECT_EQ(near.scene.origin, Vec3d{});
  EXPECT_TRUE(near.defects.empty());
  // The stray triangle costs the sheet at most 2^-20 of an edge here.
  const LoadedScene stray =
      load(folder, sheet({3, 4, 5}, "v 0 0 0\nv 64 0 0\nv 0 64 0\nf -3 -2 -1\n"));
  EXPECT_EQ(stray.scene.origin, Vec3d{});
  EXPECT_TRUE(stray.defects.empty());
}

// Triangles about as large as `scale`, a third of which lie far away along the axis. The first one
// is larger than all others. One edge of each far triangle lies along the axis.
struct FarTriangles {
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> indices;

  FarTriangles(int axis, double scale) {
    std::mt19937 random(axis);
    std::uniform_real_distribution<double> in(0, 1);
    for (int t = 0; t < 901; ++t) {
      // Far away, floats are 8 apart.
      const double size = t == 0 ? 1e6 : t % 3 == 0 ? 20 * in(random) : 1 + in(random);
      for (int k = 0; k < 3; ++k) {
        double p[3];
        for (double& v : p) v = 100 + 30 * in(random);
        if (t % 3 == 0) p[axis] += 1e8;
        if (k > 0) {
          const Vec3d& first = positions[3 * t];
          const double from[3] = {first.x / scale, first.y / scale, first.z / scale};
          const bool along = t % 3 == 0 && k == 1;  // the edge that rounding may close
          for (int i = 0; i < 3; ++i) {
            const double off = in(random);
            p[i] = from[i] + (along && i != axis ? 0 : size * (off - 0.5));
          }
        }
        indices.push_back(std::uint32_t(positions.size()));
        positions.push_back({scale * p[0], scale * p[1], scale * p[2]});
      }
    }
  }
};

std::size_t count_moved(const FarTriangles& t, const Frame& frame, double limit) {
  std::size_t count = 0;
  for (const Vec3d& p : t.positions) {
    const Vec3f s = frame.stored(p);
    count += std::abs(p.x - frame.origin.x - s.x) > limit ||
             std::abs(p.y - frame.origin.y - s.y) > limit ||
             std::abs(p.z - frame.origin.z - s.z) > limit;
  }
  return count;
}

// Along every axis and in every unit, and with all edges sorted for their median.
TEST(Frame, LossesAreThoseOfEachVertexAndTriangle) {
  for (int axis = 0; axis < 3; ++axis) {
    std::size_t moved = 0, closed = 0;
    for (const double scale : {0x1p-30, 1.0, 0x1p30}) {
      const FarTriangles t(axis, scale);
      const FilePositions file{t.positions, t.indices, std::vector<bool>(t.positions.size(), true)};
      const Frame frame{{}, diagonal_of_used(file)};
      std::vector<double> edges;
      std::size_t want_closed = 0;
      for (std::size_t i = 0; i < t.positions.size(); i += 3) {
        double longest = 0;
        bool closes = false;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3d &a = t.positions[i + k], &b = t.positions[i + (k + 1) % 3];
          longest = std::max(longest, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
          closes = closes || frame.stored(a) == frame.stored(b);
        }
        edges.push_back(longest);
        want_closed += closes;
      }
      std::sort(edges.begin(), edges.end());
      const RoundingLoss loss = rounding_loss(file, frame);
      EXPECT_EQ(loss.moved.size(), count_moved(t, frame, 1e-3 * edges[edges.size() / 2]));
      EXPECT_EQ(loss.closed.size(), want_closed);
      EXPECT_GT(loss.moved.size(), 100u);
      EXPECT_GT(loss.closed.size(), 10u);
      EXPECT_TRUE(moved == 0 || loss.moved.size() == moved) << scale;
      EXPECT_TRUE(closed == 0 || loss.closed.size() == closed) << scale;
      moved = loss.moved.size();
      closed = loss.closed.size();
    }
  }
}

// Two equal parts so far apart that no origin serves both.
TEST(Frame, WhatRoundingLosesIsADefect) {
  const TempFolder folder;
  const std::string second = sheet({1e9 + 0.125, 0, 0}, "");
  std::string relative;
  const int count = kFrameSide * kFrameSide;
  for (std::size_t begin = 0; begin < second.size();) {
    const std::size_t end = second.find('\n', begin) + 1;
    std::string line = second.substr(begin, end - begin);
    int a = 0, b = 0, c = 0;
    if (std::sscanf(line.c_str(), "f %d %d %d", &a, &b, &c) == 3)
      line = fmt::format("f {} {} {}\n", a - count - 1, b - count - 1, c - count - 1);
    relative += line;
    begin = end;
  }
  const LoadedScene loaded = load(folder, sheet({0, 0, 0}, relative));
  EXPECT_EQ(loaded.defects.count(DefectKind::position_rounded), std::uint64_t(count));
  EXPECT_EQ(loaded.defects.count(DefectKind::triangle_closed), 800u);
  EXPECT_NE(loaded.defects.lines()[0].find("moves by more than a thousandth"), std::string::npos);
}

}  // namespace
}  // namespace atlas
