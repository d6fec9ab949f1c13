#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "libatlas/charts/merging/crossing_finder.h"
#include "libatlas/core/predicates.h"

namespace atlas::test {
namespace {

struct RaggedOutline {
  std::vector<Vec2d> uvs;
  std::vector<std::array<std::uint32_t, 2>> edges;
};

// Returns a closed polygon of n corners around the origin with angles jittered by `amplitude`. If
// that is more than 1, the polygon crosses itself in many places.
RaggedOutline ragged(std::uint32_t n, double amplitude, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  RaggedOutline outline;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + amplitude * 2 * unit(random)) / n;
    const double radius = 1 + 0.3 * unit(random);
    outline.uvs.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    outline.edges.push_back({i, (i + 1) % n});
  }
  return outline;
}

double distance_to_line(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
  const double x = b.x - a.x, y = b.y - a.y;
  return std::abs(x * (p.y - a.y) - y * (p.x - a.x)) / std::sqrt(x * x + y * y);
}

Crossing all_pairs(const RaggedOutline& outline, double deep) {
  Crossing worst = Crossing::none;
  for (const auto& [a, b] : outline.edges) {
    for (const auto& [c, d] : outline.edges) {
      if (a == c || a == d || b == c || b == d) continue;
      const Vec2d &p = outline.uvs[a], &q = outline.uvs[b], &r = outline.uvs[c],
                  &s = outline.uvs[d];
      if (!segments_cross(p, q, r, s)) continue;
      const double depth = std::min({distance_to_line(r, p, q), distance_to_line(s, p, q),
                                     distance_to_line(p, r, s), distance_to_line(q, r, s)});
      worst = std::max(worst, depth > deep ? Crossing::deep : Crossing::shallow);
    }
  }
  return worst;
}

// Short borders and long ones, which are searched in groups, with no, shallow and deep crossings
// among them.
TEST(CrossingFinder, FindsWhatAllPairsDo) {
  std::mt19937_64 random(3);
  CrossingFinder check;
  std::array<int, 3> found{};
  for (int round = 0; round < 150; ++round) {
    const auto n = static_cast<std::uint32_t>(4 + random() % (round % 3 == 0 ? 700 : 60));
    const double amplitude = 0.9 + 0.1 * double(random() % 8);
    RaggedOutline outline = ragged(n, amplitude, random);
    if (round % 2) std::shuffle(outline.edges.begin(), outline.edges.end(), random);
    for (const double deep : {0.0, 0.002, 0.05}) {
      const Crossing expected = all_pairs(outline, deep);
      EXPECT_EQ(check.find(outline.edges, outline.uvs, deep), expected) << n << ' ' << deep;
      ++found[std::size_t(expected)];
    }
  }
  for (const int count : found) EXPECT_GT(count, 20);
}

// One crossing of two edges that are far apart in the list, wherever the groups begin.
TEST(CrossingFinder, FindsASingleCrossingInALongBorder) {
  std::mt19937_64 random(5);
  CrossingFinder check;
  for (std::uint32_t n = 250; n < 420; n += 7) {
    RaggedOutline outline = ragged(n, 0, random);
    EXPECT_EQ(check.find(outline.edges, outline.uvs, 1e-9), Crossing::none);
    const std::uint32_t i = std::uint32_t(random() % n), far = (i + n / 2) % n;
    outline.uvs[i] = {1.5 * outline.uvs[far].x, 1.5 * outline.uvs[far].y};
    EXPECT_NE(check.find(outline.edges, outline.uvs, 1e-9), Crossing::none) << n << ' ' << i;
  }
}

// Two teeth of a comb side by side, slightly apart or slightly overlapping. If they touch, rounding
// may decide either way.
TEST(CrossingFinder, WhatTouchesCrosses) {
  CrossingFinder check;
  for (const double turn : {0.0, 0.3, 1.1}) {
    const auto crossing = [&](double gap) {
      RaggedOutline outline;
      const std::vector<Vec2d> comb{{0, 0},         {3, 0},     {3, 2},     {1.5 + gap, 2},
                                    {1.5 + gap, 1}, {2.5, 1},   {2.5, 0.5}, {0.5, 0.5},
                                    {0.5, 0.9},     {1.5, 0.9}, {1.5, 1.9}, {0, 1.9}};
      for (const Vec2d& p : comb) {
        outline.uvs.push_back({p.x * std::cos(turn) - p.y * std::sin(turn),
                               p.x * std::sin(turn) + p.y * std::cos(turn)});
      }
      const auto n = static_cast<std::uint32_t>(outline.uvs.size());
      for (std::uint32_t i = 0; i < n; ++i) outline.edges.push_back({i, (i + 1) % n});
      return check.find(outline.edges, outline.uvs, 0.01);
    };
    EXPECT_EQ(crossing(1e-4), Crossing::none);
    for (const double gap : {1e-9, 0.0, -1e-9}) EXPECT_EQ(crossing(gap), Crossing::shallow) << gap;
    EXPECT_EQ(crossing(-0.1), Crossing::deep);
  }
}

}  // namespace
}  // namespace atlas::test
