#include <gtest/gtest.h>

#include "libatlas/charts/mesh/local_chart.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/whole_chart.h"

namespace atlas {
namespace {

TEST(LocalChart, TheWholeMeshTakesItsLinksAsTheyAre) {
  test::Whole mesh(test::grid(6, 5));
  LocalChart chart;
  chart.build(mesh.topology, mesh.partition, mesh.triangles);
  EXPECT_EQ(chart.opposite.data(), mesh.topology.opposite.data());
  EXPECT_EQ(chart.loops.size(), 1u);
  EXPECT_EQ(chart.euler(), 1);
}

TEST(LocalChart, ACutChartHasLinksOfItsOwn) {
  test::Whole mesh(test::grid(6, 5));
  std::uint32_t h = 0;
  while (mesh.topology.opposite[h] == kNoIndex) ++h;
  const std::uint32_t o = mesh.topology.opposite[h];
  mesh.partition.cut(h);
  mesh.partition.cut(o);
  LocalChart chart;
  chart.build(mesh.topology, mesh.partition, mesh.triangles);
  EXPECT_EQ(chart.opposite[h], kNoIndex);
  EXPECT_EQ(chart.opposite[o], kNoIndex);
  EXPECT_EQ(mesh.topology.opposite[h], o);
  LocalChart moved = std::move(chart);
  EXPECT_EQ(moved.opposite.size(), mesh.topology.opposite.size());
  EXPECT_EQ(moved.opposite[o], kNoIndex);
}

// Large charts give up memory, but not the numbers of their parts.
TEST(LocalChart, PartsOfAnyChartAreNumbered) {
  for (const int n : {4, 130}) {
    test::Whole mesh(test::together(test::grid(n, n), test::moved(test::grid(n, n), 1, {3, 0, 0})));
    LocalChart chart;
    chart.build(mesh.topology, mesh.partition, mesh.triangles);
    EXPECT_EQ(chart.component_count, 2u);
    EXPECT_EQ(chart.component, mesh.topology.component) << n;
  }
}

TEST(LocalChart, PositionsAreRelativeToTheFirstOne) {
  test::Shape shape = test::grid(6, 5);
  for (Vec3f& p : shape.positions) p.x += 1000;
  test::Whole mesh(shape);
  LocalChart chart;
  chart.build(mesh.topology, mesh.partition, mesh.triangles);
  const LocalMesh view = chart.mesh();
  ASSERT_EQ(view.positions.size(), chart.vertex.size());
  const Vec3f origin = mesh.topology.points[chart.vertex[0]];
  for (std::size_t v = 0; v < chart.vertex.size(); ++v) {
    const Vec3f p = mesh.topology.points[chart.vertex[v]];
    const Vec3d wanted{double(p.x) - origin.x, double(p.y) - origin.y, double(p.z) - origin.z};
    EXPECT_EQ(view.positions[v], wanted);
    EXPECT_EQ(chart.positions[v], wanted);
  }
}

}  // namespace
}  // namespace atlas
