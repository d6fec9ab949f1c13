#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libatlas/charts/cone.h"
#include "libatlas/charts/topology.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

Topology topology_of(const Mesh& mesh) {
  Result<Topology> result = build_topology(mesh.view(), {}, {});
  EXPECT_TRUE(result.ok());
  return std::move(*result);
}

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
  // Normals at 30 degrees around an axis: the cone's axis is that axis.
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

}  // namespace
}  // namespace atlas::test
