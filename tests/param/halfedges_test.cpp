// The opposites of half-edges, and the border.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "libatlas/param/local_mesh.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas {
namespace {

// Many triangles on few vertices: edges are shared by many triangles in either direction, and some
// triangles have a vertex twice. Pairs are made in order.
TEST(HalfEdges, OppositesAreTheFirstThatAreFree) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (unsigned i = 0; i < 2 + seed; ++i) {
      const std::uint32_t a = random() % 6, b = random() % 6, c = random() % 6;
      if (a != b || b != c) triangles.push_back({a, b, c});
    }
    const auto from = [&](std::uint32_t h) { return triangles[h / 3][h % 3]; };
    const auto to = [&](std::uint32_t h) { return triangles[h / 3][(h % 3 + 1) % 3]; };
    const auto count = static_cast<std::uint32_t>(3 * triangles.size());
    std::vector<std::uint32_t> wanted(count, kNoIndex);
    for (std::uint32_t h = 0; h < count; ++h) {
      for (std::uint32_t g = 0; g < count && wanted[h] == kNoIndex; ++g) {
        if (g == h || wanted[g] != kNoIndex || from(g) != to(h) || to(g) != from(h)) continue;
        wanted[h] = g;
        wanted[g] = h;
      }
    }
    param::HalfEdges half_edges;
    half_edges.build(triangles, 6);
    for (std::uint32_t h = 0; h < count; ++h)
      EXPECT_EQ(half_edges.opposite(h), wanted[h]) << seed << " " << h;
  }
}

// The mesh may keep edges apart that have the same vertices.
TEST(HalfEdges, OppositesThatAreGivenCount) {
  const std::vector<Vec3d> positions(4);
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const std::vector<std::uint32_t> none(6, kNoIndex);
  LocalMesh mesh{positions, triangles, {}};
  mesh.opposite = none;
  param::HalfEdges half_edges;
  param::HalfEdges::Border border;
  half_edges.build(mesh);
  half_edges.border(border);
  EXPECT_EQ(border.half_edges.size(), 6u);
  EXPECT_EQ(border.loop_start.size(), 3u);
}

}  // namespace
}  // namespace atlas
