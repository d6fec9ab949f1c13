// Borders that meet in vertices, which is allowed unless triangles overlap there.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

#include "libatlas/core/predicates.h"
#include "libatlas/param/injectivity.h"
#include "tests/param/oracles.h"
#include "tests/param/shapes.h"

namespace atlas {
namespace {

using testing::Disc;
using testing::drop_z;

// Returns quads between pairs of points to the left and right of a path.
Disc make_strip(const std::vector<std::array<Vec2d, 2>>& pairs) {
  Disc strip;
  for (const auto& [left, right] : pairs) {
    strip.positions.push_back({left.x, left.y, 0});
    strip.positions.push_back({right.x, right.y, 0});
  }
  for (std::uint32_t i = 0; i + 1 < pairs.size(); ++i) {
    strip.triangles.push_back({2 * i + 1, 2 * i + 3, 2 * i + 2});
    strip.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i});
  }
  return strip;
}

TEST(TouchingBorders, MayNotCrossInVertices) {
  // A strip along the x axis comes back across itself. The two borders cross at points where both
  // have vertices.
  std::vector<std::array<Vec2d, 2>> way;
  for (int x = -3; x <= 3; ++x) way.push_back({Vec2d{double(x), 1}, Vec2d{double(x), 0}});
  way.insert(way.end(), {{{{4, 1}, {5, 0}}},
                         {{{5, 2}, {8, 1}}},
                         {{{5.5, 3.5}, {9, 4}}},
                         {{{5.5, 4.5}, {8, 8}}},
                         {{{5.25, 5}, {5.5, 8}}}});
  for (int t = 5; t >= -4; --t)
    way.push_back({Vec2d{double(t), double(t)}, Vec2d{double(t), t + 1.0}});
  const Disc crossing = make_strip(way);
  const Injectivity result = check_injectivity(crossing.view(), drop_z(crossing));
  EXPECT_TRUE(result.flipped.empty());
  EXPECT_FALSE(result.injective);
  EXPECT_FALSE(result.crossings.empty());
  // If the path turns back at the axis, it only touches the first strip with a corner.
  while (way.back()[0].x < 1) way.pop_back();
  const Disc touching = make_strip(way);
  EXPECT_TRUE(testing::injective_by_pairs(touching.view(), drop_z(touching)));
  EXPECT_TRUE(check_injectivity(touching.view(), drop_z(touching)).injective);
}

// Adds triangles on edges of others, with corners at random points of a small grid. All are
// positive, many overlap, and borders often meet in vertices.
Disc grow_tree(std::mt19937& random, int triangles) {
  std::uniform_int_distribution<int> place(0, 4);
  const auto left_of = [&](const Vec3d& a, const Vec3d& b) {
    Vec3d p;
    do p = {double(place(random)), double(place(random)), 0};
    while (orientation({a.x, a.y}, {b.x, b.y}, {p.x, p.y}) <= 0);
    return p;
  };
  Disc tree;
  tree.positions = {{1, 2, 0}, {3, 2, 0}, {2, 3, 0}};
  tree.triangles = {{0, 1, 2}};
  std::vector<std::array<std::uint32_t, 2>> border = {{0, 1}, {1, 2}, {2, 0}};
  for (int i = 1; i < triangles; ++i) {
    const std::size_t at = random() % border.size();
    const auto [a, b] = border[at];
    const Vec3d &pa = tree.positions[a], &pb = tree.positions[b];
    if ((pa.x == pb.x && (pa.x == 0 || pa.x == 4)) || (pa.y == pb.y && (pa.y == 0 || pa.y == 4)))
      continue;  // perhaps there is no point to its right
    const auto apex = static_cast<std::uint32_t>(tree.positions.size());
    tree.positions.push_back(left_of(pb, pa));
    tree.triangles.push_back({b, a, apex});
    border[at] = {a, apex};
    border.push_back({apex, b});
  }
  return tree;
}

TEST(TouchingBorders, MatchExactPairsOfTriangles) {
  int injective = 0, at_corners_only = 0;
  for (unsigned seed = 0; seed < 6000; ++seed) {
    std::mt19937 random(seed);
    const Disc tree = grow_tree(random, 3 + int(seed % 8));
    const auto uv = drop_z(tree);
    const bool expected = testing::injective_by_pairs(tree.view(), uv);
    const Injectivity result = check_injectivity(tree.view(), uv);
    EXPECT_TRUE(result.flipped.empty()) << "seed " << seed;
    if (result.injective) {
      EXPECT_TRUE(expected) << "seed " << seed;
    }
    const bool segments =
        std::any_of(result.crossings.begin(), result.crossings.end(), [&](const BorderCrossing& c) {
          return segments_cross(uv[c.a[0]], uv[c.a[1]], uv[c.b[0]], uv[c.b[1]]);
        });
    if (!segments && !result.nested) {
      EXPECT_EQ(result.injective, expected) << "seed " << seed;
    }
    injective += result.injective;
    at_corners_only += !result.crossings.empty() && !segments;
  }
  EXPECT_GT(injective, 300);
  EXPECT_GT(at_corners_only, 10);
}

// Two triangles that have a corner in the same point overlap there if they do anywhere.
bool corners_share_area(const Disc& d, std::uint32_t v, std::uint32_t w) {
  const auto at = [](const auto& t, std::uint32_t x) {
    return std::find(t.begin(), t.end(), x) != t.end();
  };
  for (const auto& s : d.triangles) {
    for (const auto& t : d.triangles) {
      if (s == t || !at(s, v) || !at(t, w)) continue;
      const std::vector pair{s, t};
      if (!testing::injective_by_pairs({d.positions, pair, {}}, drop_z(d))) return true;
    }
  }
  return false;
}

// Whether the triangles at v fill a full turn or more, which is not a corner.
bool winds(const Disc& d, const std::vector<BorderCrossing>& crossings, std::uint32_t v) {
  return corners_share_area(d, v, v) ||
         std::any_of(crossings.begin(), crossings.end(), [&](const BorderCrossing& c) {
           return (c.a[1] == v && c.b[0] == v) || (c.b[1] == v && c.a[0] == v);
         });
}

TEST(TouchingBorders, CornersAreListedExactlyIfTheyOverlap) {
  int overlapping = 0, apart = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    std::mt19937 random(seed);
    const Disc tree = grow_tree(random, 4 + int(seed % 8));
    const auto uv = drop_z(tree);
    const auto crossings = check_injectivity(tree.view(), uv, {.max_crossings = 100000}).crossings;
    std::set<std::array<std::uint32_t, 2>> listed;  // vertices where the edges begin
    for (const BorderCrossing& c : crossings) {
      listed.insert({c.a[0], c.b[0]});
      listed.insert({c.b[0], c.a[0]});
    }
    for (std::uint32_t v = 0; v < uv.size(); ++v) {  // all are on the border
      for (std::uint32_t w = 0; w < v; ++w) {
        if (uv[v] != uv[w] || winds(tree, crossings, v) || winds(tree, crossings, w)) continue;
        const bool overlap = corners_share_area(tree, v, w);
        EXPECT_EQ(listed.count({v, w}) > 0, overlap) << seed << " " << v << " " << w;
        ++(overlap ? overlapping : apart);
      }
    }
  }
  EXPECT_GT(overlapping, 50);
  EXPECT_GT(apart, 50);
}

TEST(TouchingBorders, AHoleMayTouchItself) {
  // Inside a square frame, a thorn reaches from the right side of the hole to its lowest corner. Of
  // the two corners of the hole's border there, one turns like that of a hole and one like that of
  // an outline.
  Disc frame;
  const auto vertex = [](std::uint32_t x, std::uint32_t y) { return 6 * y + x; };
  for (int i = 0; i < 36; ++i) frame.positions.push_back({double(i % 6), double(i / 6), 0});
  frame.positions.push_back(frame.positions[vertex(1, 1)]);
  for (std::uint32_t x = 0; x < 5; ++x) {
    for (std::uint32_t y = 0; y < 5; ++y) {
      if (x % 4 != 0 && y % 4 != 0) continue;
      const std::uint32_t a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x + 1, y + 1);
      frame.triangles.push_back({a, b, c});
      frame.triangles.push_back({a, c, vertex(x, y + 1)});
    }
  }
  for (std::size_t at = 0; at <= frame.triangles.size(); at += 4) {
    Disc d = frame;
    d.triangles.insert(d.triangles.begin() + std::ptrdiff_t(at), {36, vertex(4, 2), vertex(4, 3)});
    const Injectivity result = check_injectivity(d.view(), drop_z(d));
    EXPECT_EQ(result.loops, 2u);
    EXPECT_TRUE(result.crossings.empty());
    EXPECT_TRUE(testing::injective_by_pairs(d.view(), drop_z(d)));
    EXPECT_TRUE(result.injective) << "thorn before triangle " << at;
  }
}

}  // namespace
}  // namespace atlas
