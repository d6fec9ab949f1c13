// Compares the charts' neighbours and vertices with their definitions, found by trying all pairs.
#include "libatlas/simplify/fine_chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/simplify/shapes.h"

namespace atlas::simplify_test {
namespace {

using simplify::FineChart;
using simplify::Geometry;

FineChart fine_chart(const ChartedMesh& mesh, std::uint32_t chart = 0) {
  const MeshView view = mesh.view();
  return simplify::build_fine_chart({&view, &mesh.charts}, chart,
                                    std::vector<bool>(mesh.triangles()));
}

// Random triangles over few vertices: many edges have one triangle, two of equal or opposite
// direction, or more.
ChartedMesh soup(std::uint32_t seed, std::uint32_t vertices, std::uint32_t triangles) {
  std::mt19937 random(seed);
  std::vector<ChartedMeshBuilder::Vertex> points;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    const float x = static_cast<float>(i), y = x * x;
    points.push_back({{x, y, 0}, {x, y}});
  }
  std::vector<std::uint32_t> corners;
  while (corners.size() < std::size_t{3} * triangles) {
    const auto a = static_cast<std::uint32_t>(random() % vertices),
               b = static_cast<std::uint32_t>(random() % vertices),
               c = static_cast<std::uint32_t>(random() % vertices);
    if (a != b && b != c && c != a) corners.insert(corners.end(), {a, b, c});
  }
  ChartedMeshBuilder builder;
  builder.add_chart(points, corners);
  return builder.build();
}

// The uv at which a half-edge starts.
std::uint32_t uv_from(const FineChart& fine, std::uint32_t h) {
  return fine.vertex_uv[fine.corners[h]];
}
std::uint32_t uv_to(const FineChart& fine, std::uint32_t h) {
  return uv_from(fine, next_half_edge(h));
}

// Returns the half-edge on the other side by the definition: exactly two half-edges lie between
// these two uvs, in opposite directions.
std::uint32_t other_side(const FineChart& fine, std::uint32_t h) {
  std::uint32_t other = kNoIndex;
  int count = 0;
  for (std::uint32_t k = 0; k < fine.corners.size(); ++k) {
    const bool along = uv_from(fine, k) == uv_from(fine, h) && uv_to(fine, k) == uv_to(fine, h);
    const bool against = uv_from(fine, k) == uv_to(fine, h) && uv_to(fine, k) == uv_from(fine, h);
    count += along || against;
    if (against) other = k;
  }
  return count == 2 ? other : kNoIndex;
}

TEST(FineChart, NeighboursAreTheOnlyTwoTrianglesAtAnEdge) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    const FineChart fine = fine_chart(soup(seed, 5 + seed % 4, 3 + seed % 9));
    for (std::uint32_t h = 0; h < fine.corners.size(); ++h) {
      EXPECT_EQ(fine.opposite[h], other_side(fine, h)) << "seed " << seed << ", half-edge " << h;
    }
  }
}

// Collects the corners that can be reached from one corner through neighbours, all at one uv.
std::set<std::uint32_t> fan(const FineChart& fine, std::uint32_t corner) {
  std::set<std::uint32_t> out;
  std::vector<std::uint32_t> stack = {corner};
  while (!stack.empty()) {
    const std::uint32_t h = stack.back();
    stack.pop_back();
    if (!out.insert(h).second) continue;
    const std::uint32_t before = previous_half_edge(h);
    if (fine.opposite[before] != kNoIndex) stack.push_back(fine.opposite[before]);
    if (fine.opposite[h] != kNoIndex) stack.push_back(next_half_edge(fine.opposite[h]));
  }
  return out;
}

TEST(FineChart, AVertexIsOneFanOfTriangles) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    const FineChart fine = fine_chart(soup(seed, 5 + seed % 4, 3 + seed % 9));
    for (std::uint32_t v = 0; v < fine.vertex_count(); ++v) {
      EXPECT_EQ(fine.from(fine.vertex_half[v]), v) << "seed " << seed;
    }
    for (std::uint32_t h = 0; h < fine.corners.size(); ++h) {
      const std::set<std::uint32_t> expected = fan(fine, h);
      std::set<std::uint32_t> found;
      bool border = false;
      for (std::uint32_t k = 0; k < fine.corners.size(); ++k) {
        if (fine.corners[k] == fine.corners[h]) found.insert(k);
      }
      for (const std::uint32_t k : expected) border = border || fine.opposite[k] == kNoIndex;
      EXPECT_EQ(found, expected) << "seed " << seed << ", corner " << h;
      EXPECT_EQ(fine.border(fine.corners[h]), border);
      EXPECT_TRUE(expected.count(fine.vertex_half[fine.corners[h]]));
      if (!border) continue;
      const std::uint32_t into = fine.border_into(fine.corners[h]);
      EXPECT_EQ(fine.opposite[into], kNoIndex);
      EXPECT_EQ(fine.to(into), fine.corners[h]);
    }
  }
}

// A triangle is dropped whichever two of its corners are at one position, also if the uvs differ.
TEST(FineChart, TrianglesWithTwoEqualPositionsAreDropped) {
  for (int k = 0; k < 3; ++k) {
    std::vector<ChartedMeshBuilder::Vertex> vertices = {
        {{0, 0, 0}, {0, 0}}, {{1, 0, 0}, {1, 0}}, {{0, 1, 0}, {0, 1}}};
    vertices[k].position = vertices[(k + 1) % 3].position;
    ChartedMeshBuilder builder;
    builder.add_chart(vertices, {0, 1, 2});
    const FineChart fine = fine_chart(builder.build());
    EXPECT_EQ(fine.dropped, 1U) << k;
    EXPECT_EQ(fine.triangle_count(), 0U) << k;
  }
}

// A floor with y = 0 along the middle, and a wall on it whose vertices have y = zero.
std::uint64_t cuts_under_a_wall(float zero) {
  constexpr int n = 16;
  ChartedMeshBuilder builder;
  builder.add_grid(n, n, [](double s, double t) {
    return ChartedMeshBuilder::Vertex{{float(2 * s - 1), float(2 * t - 1), 0}, {s, t}};
  });
  builder.add_grid(n, n, [](double s, double t) {
    return ChartedMeshBuilder::Vertex{{float(2 * s - 1), 7, float(t)}, {s, t}};
  });
  ChartedMesh mesh = builder.build();
  for (Vec3f& p : mesh.positions) {
    if (p.y == 7) p.y = zero;
  }
  const MeshView view = mesh.view();
  const Geometry geometry{&view, &mesh.charts};
  std::vector<FineChart> fine = {fine_chart(mesh, 0), fine_chart(mesh, 1)};
  return simplify::cut_shared_edges(geometry, fine, {});
}

TEST(FineChart, ZeroAndMinusZeroAreOnePoint) {
  EXPECT_EQ(cuts_under_a_wall(0.0F), 16U);
  EXPECT_EQ(cuts_under_a_wall(-0.0F), 16U);
  EXPECT_EQ(cuts_under_a_wall(0.001F), 0U);
}

}  // namespace
}  // namespace atlas::simplify_test
