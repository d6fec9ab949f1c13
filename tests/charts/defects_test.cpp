#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "libatlas/core/random.h"
#include "tests/charts/chart_checks.h"
#include "tests/support/slowness.h"

namespace atlas::test {
namespace {

// A band of n quads that is twisted by half_turns * 180 degrees before its ends meet.
Mesh band(int n, int half_turns) {
  Mesh mesh;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n, tilt = half_turns * a / 2;
    for (const double r : {-0.3, 0.3}) {
      const double d = 1 + r * std::cos(tilt);
      mesh.positions.push_back(
          {float(d * std::cos(a)), float(d * std::sin(a)), float(r * std::sin(tilt))});
    }
  }
  for (int i = 0; i < n; ++i) {
    const bool turned = i == n - 1 && half_turns % 2;
    const auto a = std::uint32_t(2 * i), b = a + 1;
    const auto c = std::uint32_t(2 * ((i + 1) % n) + (turned ? 1 : 0));
    const auto d = turned ? c - 1 : c + 1;
    for (const std::uint32_t v : {a, b, c, b, d, c}) mesh.indices.push_back(v);
  }
  return mesh;
}

// The outer faces of cubes that fill half of a grid of 4 x 4 x 4 at random.
Mesh cubes(std::uint64_t seed) {
  constexpr int kSide = 4;
  std::mt19937_64 random(seed);
  std::array<bool, kSide * kSide * kSide> full;
  for (bool& cube : full) cube = uniform(random) < 0.5;
  full[0] = true;
  const auto filled = [&](std::array<int, 3> p) {
    for (const int c : p) {
      if (c < 0 || c >= kSide) return false;
    }
    return full[std::size_t((p[0] * kSide + p[1]) * kSide + p[2])];
  };
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> vertices;
  const auto corner = [&](std::array<int, 3> p) {
    const auto [at, added] = vertices.try_emplace(p, std::uint32_t(mesh.positions.size()));
    if (added) mesh.positions.push_back({float(p[0]), float(p[1]), float(p[2])});
    return at->second;
  };
  for (int i = 0; i < 3 * 2 * kSide * kSide * kSide; ++i) {
    const int axis = i % 3, out = i / 3 % 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::array<int, 3> p{i / 6 / kSide / kSide, i / 6 / kSide % kSide, i / 6 % kSide};
    std::array<int, 3> next = p, q = p;
    next[axis] += out ? 1 : -1;
    if (!filled(p) || filled(next)) continue;
    q[axis] += out;
    std::array<std::uint32_t, 4> face;
    for (int k = 0; k < 4; ++k) {
      std::array<int, 3> at = q;
      at[u] += k == 1 || k == 2;
      at[v] += k >= 2;
      face[std::size_t(out ? k : 3 - k)] = corner(at);
    }
    for (const int k : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(face[std::size_t(k)]);
  }
  return mesh;
}

// Charts of cubes touch themselves when they unroll. After they are rotated for the packer they
// must not overlap, although rounding moves touching parts.
TEST(Defects, ChartsOfCubesTouchButDoNotOverlap) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const Mesh mesh = cubes(seed);
    ChartOptions options;
    options.preset = seed % 2 ? ChartPreset::standard : ChartPreset::fast;
    const Result<ChartSet> set = make_charts(mesh.view(), options, {});
    ASSERT_TRUE(set.ok());
    EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
  }
}

// Pieces that are cut off to save page area keep to the cone, too.
TEST(Defects, PiecesOfCubesStayWithinAWideCone) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const Mesh mesh = cubes(seed);
    ChartOptions options;
    options.cone_degrees = 120;
    options.max_stretch = 1.01;
    const Result<ChartSet> set = make_charts(mesh.view(), options, {});
    ASSERT_TRUE(set.ok());
    const ChartFindings found = check_charts(mesh.view(), *set);
    EXPECT_EQ(found.fault, "");
    EXPECT_LE(found.cone_degrees, 120.01);
  }
}

TEST(Defects, AMoebiusStripIsCut) {
  const ChartSet set = checked_charts(band(40, 1));
  EXPECT_LE(set.charts.size(), 5u);
  EXPECT_GT(set.seam_length, 0.5);
}

// The edges between two triangles count as seams where the strip is cut, and those with a fin do
// not.
TEST(Defects, TheCutOfAMoebiusStripIsMeasured) {
  for (const bool fins : {false, true}) {
    for (const bool reversed : {false, true}) {
      Mesh mesh = band(40, 1);
      for (std::uint32_t v = 0; fins && v < 80; v += 2) {
        const Vec3f p = mesh.positions[v], q = mesh.positions[v + 1];
        const auto tip = std::uint32_t(mesh.positions.size());
        mesh.positions.push_back({0.6f * (p.x + q.x), 0.6f * (p.y + q.y), 0.5f * (p.z + q.z) + 1});
        mesh.indices.insert(mesh.indices.end(), {v, v + 1, tip});
      }
      if (reversed) std::reverse(mesh.indices.begin(), mesh.indices.end());
      for (Vec3f& p : mesh.positions) p = {50 * p.x, 50 * p.y, 50 * p.z};
      const ChartSet set = checked_charts(mesh);
      const double seam = check_charts(mesh.view(), set).seam;
      EXPECT_NEAR(set.seam_length, seam, 1e-4 * (1 + seam)) << fins << reversed;
    }
  }
}

TEST(Defects, PiecesOfMixedOrientationAreTurned) {
  Mesh mesh(grid(10, 10));
  for (std::size_t t = 0; t < mesh.indices.size() / 3; t += 3) {
    std::swap(mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]);
  }
  const ChartSet set = checked_charts(mesh);
  EXPECT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(set.flipped_triangles.size(), (mesh.indices.size() / 3 + 2) / 3);
  EXPECT_GT(set.repairs.misoriented_edges, 0u);
}

// Few triangles with most of the area count for more than many small ones.
TEST(Defects, APieceKeepsTheOrientationOfMostOfItsArea) {
  for (const bool large_first : {true, false}) {
    for (const bool large_turned : {true, false}) {
      Mesh mesh(grid(10, 1));
      for (Vec3f& p : mesh.positions) p.x = p.x > 0.75f ? 100 * p.x : p.x;
      if (large_first) std::reverse(mesh.indices.begin(), mesh.indices.end());
      std::vector<std::uint32_t> small;
      for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
        std::uint32_t* const v = &mesh.indices[3 * std::size_t{t}];
        const bool large =
            std::any_of(v, v + 3, [&](std::uint32_t k) { return mesh.positions[k].x > 1; });
        if (large == large_turned) std::swap(v[1], v[2]);
        if (!large) small.push_back(t);
      }
      ASSERT_EQ(small.size(), 14u);
      EXPECT_EQ(checked_charts(mesh).flipped_triangles, small) << large_first << large_turned;
    }
  }
}

TEST(Defects, FansOfSheetsAroundAnEdge) {
  const ChartSet set = checked_charts(Mesh(sheets(7)));
  EXPECT_EQ(set.repairs.nonmanifold_edges, 1u);
  EXPECT_EQ(set.charts.size(), 4u) << "the flattest pairs continue each other";
}

TEST(Defects, TwoConesAtOneVertex) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}};
  for (const float z : {1.0f, -1.0f}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i < 6; ++i) {
      mesh.positions.push_back({float(std::cos(i * M_PI / 3)), float(std::sin(i * M_PI / 3)), z});
    }
    for (std::uint32_t i = 0; i < 6; ++i) {
      for (const std::uint32_t v : {0u, first + i, first + (i + 1) % 6}) mesh.indices.push_back(v);
    }
  }
  EXPECT_EQ(checked_charts(mesh).repairs.nonmanifold_vertices, 1u);
}

TEST(Defects, DuplicatesGetPlacesOfTheirOwn) {
  Mesh mesh(grid(4, 4));
  const std::vector<std::uint32_t> copy(mesh.indices.begin(), mesh.indices.begin() + 12);
  mesh.indices.insert(mesh.indices.end(), copy.begin(), copy.end());
  const ChartSet set = checked_charts(mesh);
  EXPECT_EQ(set.repairs.duplicate_triangles, 4u);
}

TEST(Defects, ADoubledSurfaceIsTwoSheets) {
  Mesh mesh(grid(6, 6));
  const std::vector<std::uint32_t> front = mesh.indices;
  for (std::size_t i = 0; i < front.size(); i += 3) {
    for (const std::size_t k : {i, i + 2, i + 1}) mesh.indices.push_back(front[k]);
  }
  EXPECT_EQ(checked_charts(mesh).charts.size(), 2u);
}

// Each of the coincident sheets becomes a chart, however many there are.
TEST(Defects, FortySheetsUponEachOther) {
  Mesh mesh(grid(6, 6));
  const std::vector<std::uint32_t> sheet = mesh.indices;
  for (int k = 1; k < 40; ++k) mesh.indices.insert(mesh.indices.end(), sheet.begin(), sheet.end());
  const ChartSet set = checked_charts(mesh);
  EXPECT_EQ(set.charts.size(), 40u);
  EXPECT_EQ(set.repairs.duplicate_triangles, 39 * sheet.size() / 3);
}

TEST(Defects, TrianglesWithoutAreaJoinTheirNeighbours) {
  Mesh mesh(grid(6, 6));
  const std::size_t before = mesh.indices.size() / 3;
  mesh.positions.push_back({0.25f, 0.5f, 0});
  const auto apart = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (const std::uint32_t v : {0u, 0u, 1u, 0u, 1u, 2u, apart, apart, apart}) {
    mesh.indices.push_back(v);
  }
  const ChartSet set = checked_charts(mesh);
  EXPECT_EQ(set.repairs.degenerate_triangles, 3u);
  EXPECT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(set.triangle_chart.size(), before + 3);
}

// Corners of such a triangle that the neighbour has get the neighbour's uvs.
TEST(Defects, TrianglesWithoutAreaLieOnTheirNeighbours) {
  Mesh mesh(box(2));
  const std::size_t first = mesh.indices.size();
  for (std::uint32_t t = 0; t < first / 3; ++t) {
    const std::uint32_t a = mesh.indices[3 * t], b = mesh.indices[3 * t + 1];
    for (const std::uint32_t v : {a, a, b, b, a, b, a, b, b}) mesh.indices.push_back(v);
  }
  const ChartSet set = checked_charts(mesh);
  for (std::size_t i = first; i < mesh.indices.size(); ++i) {
    EXPECT_EQ(mesh.positions[set.uv_vertex[set.triangle_uv[i]]], mesh.positions[mesh.indices[i]]);
  }
}

// A common corner will do, but not a chart of another material.
TEST(Defects, TrianglesWithoutAreaJoinTheChartAtTheirCorner) {
  Mesh mesh(together(grid(3, 3), moved(grid(3, 3), 1, {0, 0, 5})));
  const auto apart = std::uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{7, 7, 7}, {8, 8, 8}});
  const std::uint32_t plate = mesh.indices.back();  // a corner of the second plate
  mesh.materials.assign(mesh.indices.size() / 3, 0);
  std::fill(mesh.materials.begin() + 18, mesh.materials.end(), 1);
  for (const std::uint32_t v : {apart, plate, apart, apart, apart, plate, plate, apart + 1, plate})
    mesh.indices.push_back(v);
  mesh.materials.insert(mesh.materials.end(), {1, 0, 1});
  const ChartSet set = checked_charts(mesh);
  ASSERT_EQ(set.charts.size(), 2u);
  EXPECT_EQ(set.triangle_chart[36], set.triangle_chart[18]);
  EXPECT_EQ(set.triangle_chart[37], set.triangle_chart[0]);
  EXPECT_EQ(set.triangle_chart[38], set.triangle_chart[18]);
  mesh.materials.clear();
  const ChartSet alike = checked_charts(mesh);
  for (const std::size_t t : {36, 37, 38})
    EXPECT_EQ(alike.triangle_chart[t], alike.triangle_chart[18]) << t;
}

TEST(Defects, NothingButTrianglesWithoutArea) {
  Mesh mesh;
  mesh.positions = {{1, 2, 3}, {1, 2, 3}, {4, 5, 6}};
  mesh.indices = {0, 1, 2, 2, 2, 2};
  const ChartSet set = checked_charts(mesh);
  EXPECT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(set.seam_length, 0);
}

// Degenerate triangles that touch nothing, with materials that other triangles have or do not have.
TEST(Defects, TrianglesWithoutAreaJoinTheirMaterial) {
  constexpr std::uint32_t kTriangles = 40000, kMaterials = 20000;
  Mesh mesh;
  for (std::uint32_t t = 0; t < kTriangles; ++t) {
    const float x = 3 * float(t % 200), y = 3 * float(t / 200);
    mesh.positions.insert(mesh.positions.end(), {{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}});
    for (std::uint32_t c = 0; c < 3; ++c) mesh.indices.push_back(3 * t + c);
    mesh.materials.push_back(t % kMaterials);
  }
  for (std::uint32_t i = 0; i < 2 * kMaterials; ++i) {  // each material twice; half of them are new
    const auto apart = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back({-1 - float(i), -5, 1});
    mesh.indices.insert(mesh.indices.end(), 3, apart);
    mesh.materials.push_back(kMaterials / 2 + i % kMaterials);
  }
  const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
  ASSERT_TRUE(set.ok()) << set.status().message();
  EXPECT_EQ(set->charts.size(), kTriangles + kMaterials / 2);
  for (std::uint32_t t = 0; t < mesh.materials.size(); ++t)
    ASSERT_EQ(set->charts[set->triangle_chart[t]].material, mesh.materials[t]) << t;
  // A search through all charts for each of these triangles took more than ten times as long.
  EXPECT_LT(set->timing.parameterization_cpu, 0.125 * kSlowness);
}

TEST(Defects, SlicedNeedlesAndSoup) {
  EXPECT_EQ(checked_charts(Mesh(needles(200, 1e5))).charts.size(), 1u);
  EXPECT_EQ(checked_charts(Mesh(soup(300, 4))).charts.size(), 300u);
}

// No piece equals another, so each is cut by itself.
TEST(Defects, ManyTinyPiecesAreQuick) {
  Shape shape = box(1);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3f& p : shape.positions) {
      mesh.positions.push_back(
          {p.x + 2.0f * float(i % 60), p.y + 2.0f * float(i / 60), p.z * (1 + 1e-3f * float(i))});
    }
    for (const std::uint32_t v : shape.indices) mesh.indices.push_back(base + v);
  }
  const ChartSet set = checked_charts(mesh);
  EXPECT_EQ(set.copied_pieces, 0u);
  EXPECT_LE(set.charts.size(), 3000u * 3);
  EXPECT_NEAR(set.distortion.stretch_l2, 1, 1e-6);
  // About ten microseconds per triangle are expected.
  EXPECT_LT(set.timing.segmentation_cpu + set.timing.parameterization_cpu, 0.5 * kSlowness);
}

}  // namespace
}  // namespace atlas::test
