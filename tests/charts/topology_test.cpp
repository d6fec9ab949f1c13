#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/mesh/topology.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

TEST(Topology, LinksAgreeWithAMapOfEdges) {
  for (const Shape& shape : zoo()) {
    const Mesh mesh(shape);
    const Topology topology = topology_of(mesh);
    const auto from = [&](std::uint32_t h) { return topology.corner_vertex[h]; };
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      if (!topology.degenerate(h / 3)) {
        ++edges[std::minmax(from(h), from(next_half_edge(h)))];
      }
    }
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (topology.degenerate(h / 3)) {
        EXPECT_EQ(o, kNoIndex);
        continue;
      }
      const int sides = edges[std::minmax(from(h), from(next_half_edge(h)))];
      if (o == kNoIndex) continue;
      EXPECT_GE(sides, 2) << shape.name;
      ASSERT_EQ(topology.opposite[o], h) << shape.name;
      EXPECT_EQ(from(h), from(next_half_edge(o))) << shape.name;
      EXPECT_EQ(from(next_half_edge(h)), from(o)) << shape.name;
      EXPECT_EQ(topology.component[h / 3], topology.component[o / 3]) << shape.name;
    }
  }
}

TEST(Topology, PiecesAreNumberedInTheOrderOfTheirFirstTriangles) {
  for (const Shape& shape : zoo()) {
    const Topology topology = topology_of(Mesh(shape));
    std::vector<std::uint32_t> piece(topology.triangle_count(), kNoIndex);
    std::uint32_t count = 0;
    for (std::uint32_t seed = 0; seed < piece.size(); ++seed) {
      if (piece[seed] != kNoIndex || topology.degenerate(seed)) continue;
      std::vector<std::uint32_t> queue{seed};
      piece[seed] = count;
      for (std::size_t i = 0; i < queue.size(); ++i) {
        for (std::uint32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
          const std::uint32_t o = topology.opposite[h];
          if (o == kNoIndex || piece[o / 3] != kNoIndex) continue;
          piece[o / 3] = count;
          queue.push_back(o / 3);
        }
      }
      ++count;
    }
    EXPECT_EQ(topology.component_count, count) << shape.name;
    EXPECT_EQ(topology.component, piece) << shape.name;
  }
}

TEST(Topology, VerticesOfSeveralFansAreCountedOnce) {
  // Three closed fans around vertex 0, and two with a border around vertex 1.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {5, 0, 0}};
  const auto fan = [&](std::uint32_t centre, std::uint32_t corners, bool closed) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const float height = static_cast<float>(first);
    for (std::uint32_t i = 0; i < corners; ++i) {
      const float angle = 1.2f * static_cast<float>(i);
      mesh.positions.push_back({std::cos(angle), std::sin(angle), height});
      if (i + 1 < corners)
        mesh.indices.insert(mesh.indices.end(), {centre, first + i, first + i + 1});
    }
    if (closed) mesh.indices.insert(mesh.indices.end(), {centre, first + corners - 1, first});
  };
  for (int i = 0; i < 3; ++i) fan(0, 5, true);
  for (int i = 0; i < 2; ++i) fan(1, 4, false);
  EXPECT_EQ(topology_of(mesh).defects.nonmanifold_vertices, 2u);
}

TEST(Topology, NamesTheTriangleWhosePositionIsNotFinite) {
  Mesh mesh(icosphere(1));
  mesh.positions.push_back({NAN, 0, 0});  // no triangle uses it, so it is no error
  EXPECT_TRUE(build_topology(mesh.view(), {}, {}).ok());
  mesh.indices[7] = static_cast<std::uint32_t>(mesh.positions.size()) - 1;
  const std::string message = build_topology(mesh.view(), {}, {}).status().message();
  EXPECT_NE(message.find("triangle 2"), std::string::npos) << message;
}

// Neither unit nor links depend on such vertices, however far away they lie.
TEST(Topology, VerticesThatNoTriangleUsesChangeNothing) {
  Mesh mesh(icosphere(2));
  const Topology alone = topology_of(mesh);
  mesh.positions.insert(mesh.positions.end(), {{1e6f, 0, 0}, {0, 0, -1e9f}, mesh.positions[0]});
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.scale, alone.scale);
  EXPECT_EQ(topology.points, alone.points);
  EXPECT_EQ(topology.corner_vertex, alone.corner_vertex);
}

// The height of three points over their longest side decides, whichever of them comes first.
TEST(Topology, AnyFirstCornerMayHaveNoArea) {
  for (const float height : {0.95e-12f, 2e-12f}) {
    for (std::uint32_t first = 0; first < 3; ++first) {
      Mesh mesh;
      mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, height, 0}};
      mesh.indices = {first, (first + 1) % 3, (first + 2) % 3};
      EXPECT_EQ(topology_of(mesh).degenerate(0), height < 1e-12f) << height << ' ' << first;
    }
  }
}

// Two halves of a sheet that were rotated in double by a right angle each, so that their common
// edge lies at 0 in one half and at 1e-16 in the other.
TEST(Topology, RoundingAroundZeroLeavesNoCrack) {
  for (const float size : {1.0f, 1e-6f, 3e5f}) {
    const float nearly = 2.4e-16f * size, next = -6e-33f * size;
    Mesh mesh;
    mesh.positions = {{size, 0, 0},      {size, size, 0},         {0, 0, 0},
                      {0, size, nearly}, {nearly, next, -nearly}, {next, size, 0},
                      {-size, 0, 0},     {-size, size, 0}};
    mesh.indices = {0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7};
    const Topology topology = topology_of(mesh);
    EXPECT_EQ(topology.points.size(), 6u);
    EXPECT_EQ(topology.component_count, 1u);
  }
}

TEST(Topology, CoincidentVerticesAreWelded) {
  const Shape shape = icosphere(2);
  Mesh mesh;
  for (const std::uint32_t v : shape.indices) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(shape.positions[v]);
  }
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.points.size(), shape.positions.size());
  EXPECT_EQ(topology.component_count, 1u);
  EXPECT_EQ(std::count(topology.opposite.begin(), topology.opposite.end(), kNoIndex), 0);
}

TEST(NormalCone, IsTheSmallestOfThreeNormals) {
  // Normals at the same angle around an axis: the axis of the cone is that axis.
  const float s = std::sin(0.5f), c = std::cos(0.5f);
  const std::vector<Vec3f> normals = {{s, 0, c},
                                      {-0.5f * s, 0.8660254f * s, c},
                                      {-0.5f * s, -0.8660254f * s, c},
                                      {0, 0, 1},
                                      {s, 0, c}};
  const std::vector<std::uint32_t> ids = {0, 1, 2, 3, 4};
  const NormalCone cone = normal_cone(normals, ids);
  EXPECT_NEAR(cone.angle, 0.5, 1e-5);
  EXPECT_NEAR(cone.axis.z, 1, 1e-5);
  const std::vector<std::uint32_t> pair = {0, 3};
  EXPECT_NEAR(normal_cone(normals, pair).angle, 0.25, 1e-5);
  const std::vector<std::uint32_t> one = {3};
  EXPECT_NEAR(normal_cone(normals, one).angle, 0, 1e-5);
}

TEST(NormalCone, TrianglesWithoutNormalDoNotCount) {
  const std::vector<Vec3f> normals = {{0, 0, 0}, {0.6f, 0, 0.8f}, {0, 0, 0}, {-0.6f, 0, 0.8f}};
  EXPECT_NEAR(normal_cone(normals).angle, std::asin(0.6), 1e-6);
  EXPECT_NEAR(normal_cone(normals).axis.z, 1, 1e-6);
}

// The part has opposite sides of a box, so the sum of its normals is the worst possible axis. The
// axis of the whole is within 90 degrees of all of them.
TEST(NormalCone, OfAPartIsNotWiderThanTheWhole) {
  const std::vector<Vec3f> normals = {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1},
                                      {0, 1, 0},  {0, 1, 0},  {0, 1, 0}};
  const std::vector<std::uint32_t> ids = {0, 1, 2, 3, 4, 5};
  const float half = std::sqrt(0.5f);
  const NormalCone whole{{-half, 0, -half}, 1.8};
  EXPECT_GT(normal_cone(normals, ids).angle, 2);
  EXPECT_NEAR(part_of_cone(normals, ids, whole).angle, M_PI / 2, 1e-6);
  const std::vector<std::uint32_t> one = {3};
  EXPECT_NEAR(part_of_cone(normals, one, whole).angle, 0, 1e-5);
}

// Coordinates of a few steps of the smallest float. The factor that would scale them to unit size
// exceeds the range of float.
TEST(Topology, DenormalCoordinatesAreScaledToo) {
  Mesh mesh(grid(4, 4));
  for (Vec3f& p : mesh.positions) p = {p.x * 0x1p-146f, p.y * 0x1p-146f, 0};
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.points.size(), mesh.positions.size());
  for (const Vec3f& p : topology.points) EXPECT_TRUE(p.x >= 0 && p.x <= 2 && p.y >= 0 && p.y <= 2);
  EXPECT_EQ(topology.defects.degenerate_triangles, 0u);
  const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
  ASSERT_TRUE(set.ok()) << set.status().message();
  EXPECT_EQ(set->charts.size(), 1u);
  EXPECT_EQ(set->distortion.degenerate, 0u);
}

// A strip of quads around a circle, with half a turn, or a tube that is closed so (a Klein bottle).
Mesh half_turned(std::uint32_t along, std::uint32_t across, bool tube) {
  Mesh mesh;
  const std::uint32_t rows = across + (tube ? 0 : 1);
  for (std::uint32_t i = 0; i < along; ++i) {
    const double a = 2 * M_PI * i / along;
    for (std::uint32_t j = 0; j < rows; ++j) {
      const double b = 2 * M_PI * j / across, x = tube ? std::sin(b) : double(j) / across - 0.5,
                   z = tube ? std::sin(2 * b) : 0, c = std::cos(a / 2), s = std::sin(a / 2);
      const double r = 3 + c * x - s * z;
      mesh.positions.push_back(
          {float(r * std::cos(a)), float(r * std::sin(a)), float(s * x + c * z)});
    }
  }
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    if (i == along) return tube ? (2 * across - j) % across : across - j;
    return i * rows + (tube ? j % across : j);
  };
  for (std::uint32_t i = 0; i < along; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      for (const auto& [di, dj] :
           {std::pair{0u, 0u}, {1u, 0u}, {1u, 1u}, {0u, 0u}, {1u, 1u}, {0u, 1u}}) {
        mesh.indices.push_back(vertex(i + di, j + dj));
      }
    }
  }
  return mesh;
}

std::vector<std::uint32_t> turned_triangles(const Topology& topology) {
  std::vector<std::uint32_t> turned;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    if (topology.flags[t] & Topology::kFlipped) turned.push_back(t);
  }
  return turned;
}

// A surface that cannot be oriented is cut where its triangles disagree in the input, and nowhere
// else.
TEST(Topology, WhatCannotBeOrientedIsCutWhereItDisagrees) {
  for (const bool tube : {false, true}) {
    const Mesh mesh = half_turned(120, 8, tube);
    const Topology topology = topology_of(mesh);
    EXPECT_EQ(topology.defects.misoriented_edges, 8u) << tube;
    EXPECT_EQ(topology.component_count, 1u) << tube;
    EXPECT_TRUE(turned_triangles(topology).empty()) << tube;
    const auto open = std::count(topology.opposite.begin(), topology.opposite.end(), kNoIndex);
    EXPECT_EQ(open, 2 * 8 + (tube ? 0 : 2 * 120)) << tube;
  }
}

TEST(Topology, StrayTrianglesAreTurnedOnSuchSurfacesToo) {
  for (const bool tube : {false, true}) {
    Mesh mesh = half_turned(120, 8, tube);
    const std::vector<std::uint32_t> stray{100, 500, 501, 502, 1000};
    for (const std::uint32_t t : stray) std::swap(mesh.indices[3 * t], mesh.indices[3 * t + 1]);
    const Topology topology = topology_of(mesh);
    EXPECT_EQ(turned_triangles(topology), stray) << tube;
    const auto open = std::count(topology.opposite.begin(), topology.opposite.end(), kNoIndex);
    EXPECT_EQ(open, 2 * 8 + (tube ? 0 : 2 * 120)) << tube;
  }
}

// Either of the two half-edges of an edge may be marked.
TEST(Topology, SeamsAreNotLinked) {
  const Mesh mesh(icosphere(2));
  const Topology whole = topology_of(mesh);
  std::vector<std::uint8_t> seams(mesh.indices.size(), 0);
  for (std::uint32_t h = 0; h < seams.size(); h += 7) seams[h] = 1;
  MeshView view = mesh.view();
  view.seams = seams;
  const auto cut = build_topology(view, {}, {});
  ASSERT_TRUE(cut.ok()) << cut.status().message();
  double length = 0;
  for (std::uint32_t h = 0; h < seams.size(); ++h) {
    const std::uint32_t o = whole.opposite[h];
    const bool seam = seams[h] || seams[o];
    EXPECT_EQ(cut->opposite[h], seam ? kNoIndex : o) << h;
    if (seam && h < o) length += edge_length(*cut, h);
  }
  EXPECT_NEAR(cut->cut_length, length / cut->scale, 1e-9);
  seams.pop_back();
  view.seams = seams;
  EXPECT_EQ(build_topology(view, {}, {}).status().message(),
            "mesh: seams must be empty or 3 a triangle");
}

}  // namespace
}  // namespace atlas::test
