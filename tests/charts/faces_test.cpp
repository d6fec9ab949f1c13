// The flat faces of parts, and the cells that they bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/cells/faces.h"
#include "libatlas/charts/charts.h"
#include "tests/charts/coarse_shapes.h"
#include "tests/charts/toothed_wheel.h"

namespace atlas::test {
namespace {

struct Part {
  Topology topology;
  CellPlan plan;
  Regions faces;
};

Part part_of(const Shape& shape) {
  Topology topology = topology_of(shape);
  const CellPlan plan = plan_cells(topology, {});
  Regions faces = find_faces(topology, plan);
  return {std::move(topology), plan, std::move(faces)};
}

std::size_t count(const Regions& faces) {
  std::set<std::uint32_t> names(faces.of_triangle.begin(), faces.of_triangle.end());
  names.erase(kNoIndex);
  return names.size();
}

TEST(Faces, OfABoxAreItsSides) {
  const Part part = part_of(box(12, {3, 2, 0.5}));
  EXPECT_EQ(count(part.faces), 6u);
  EXPECT_NEAR(part.faces.share[0], 1, 1e-6);
  std::map<std::uint32_t, Vec3f> normal_of;
  for (std::uint32_t t = 0; t < part.topology.triangle_count(); ++t) {
    const Vec3f n = part.topology.normals[t];
    const Vec3f m = normal_of.try_emplace(part.faces.of_triangle[t], n).first->second;
    EXPECT_GT(n.x * m.x + n.y * m.y + n.z * m.z, 0.9999f);
  }
}

TEST(Faces, AreNotFoundOnRoundOrRoughSurfaces) {
  for (const Shape& shape : {geodesic_sphere(30), torus(72, 36), noisy(box(30), 0.01, 3)}) {
    const Part part = part_of(shape);
    EXPECT_EQ(count(part.faces), 0u) << shape.name;
    EXPECT_EQ(part.faces.share[0], 0) << shape.name;
  }
}

TEST(Faces, AreNoFacetsOfSomethingRound) {
  for (const Shape& shape : {cylinder(400, 20), cone(60, 30, 0.5), torus(24, 12)}) {
    EXPECT_EQ(count(part_of(shape).faces), 0u) << shape.name;
  }
  EXPECT_EQ(count(part_of(cylinder(6, 20)).faces), 6u);  // the sides of a hexagonal prism
}

TEST(Faces, BoundCells) {
  for (const Shape& shape : {box(12, {3, 2, 0.5}), plate_with_holes(5, 12), cylinder(60, 10),
                             together(box(9), geodesic_sphere(12))}) {
    const Part part = part_of(shape);
    const Cells cells = grow_cells({part.topology, part.plan, &part.faces}, {}, {});
    std::vector<std::set<std::uint32_t>> faces_of(cells.count);
    for (std::uint32_t t = 0; t < part.topology.triangle_count(); ++t) {
      ASSERT_LT(cells.of_triangle[t], cells.count) << shape.name;
      faces_of[cells.of_triangle[t]].insert(part.faces.of_triangle[t]);
    }
    for (const auto& faces : faces_of) EXPECT_EQ(faces.size(), 1u) << shape.name;
  }
}

TEST(Faces, OfPiecesLeftOutAreNone) {
  const Part part = part_of(together(box(9), geodesic_sphere(12)));
  const std::vector<std::uint8_t> left_out{1, 0};
  const Regions faces = find_faces(part.topology, part.plan, left_out);
  EXPECT_EQ(count(faces), 0u);
  EXPECT_EQ(faces.share, (std::vector<double>{0, 0}));
}

// Cells of such wheels hold several teeth unless faces bound them: with more than 20 000 triangles
// they came out in more than a thousand charts.
TEST(Faces, BoundCellsOfLargePartsWithManyTeeth) {
  const Shape wheel = toothed_wheel(1600, 0.1);
  ASSERT_GT(wheel.triangle_count(), 20000u);
  for (const ChartPreset preset : {ChartPreset::standard, ChartPreset::fast}) {
    ChartOptions options;
    options.preset = preset;
    const Mesh mesh(wheel);
    const Result<ChartSet> set = make_charts(mesh.view(), options, {});
    ASSERT_TRUE(set.ok());
    EXPECT_LT(set->charts.size(), 40u);
  }
}

// The fans of this wheel's cells err little, since its walls are low beside wide caps. How many
// charts remain is a matter of luck: 4 with one preset, 77 with another.
TEST(Faces, BoundCellsOfLargePartsWithFoldsInTheirCells) {
  const Mesh wheel(low_toothed_wheel());
  ASSERT_GT(wheel.indices.size(), 3 * 20000u);
  for (const ChartPreset preset : {ChartPreset::standard, ChartPreset::fast}) {
    ChartOptions options;
    options.preset = preset;
    const Result<ChartSet> set = make_charts(wheel.view(), options, {});
    ASSERT_TRUE(set.ok());
    EXPECT_LT(set->charts.size(), 100u) << int(preset);
  }
}

TEST(Cells, OfPiecesLeftOutAreNone) {
  const Part part = part_of(together(box(9), geodesic_sphere(12)));
  const std::vector<std::uint8_t> left_out{1, 0};
  const Cells cells = grow_cells({part.topology, part.plan, nullptr, left_out}, {}, {});
  for (std::uint32_t t = 0; t < part.topology.triangle_count(); ++t) {
    EXPECT_EQ(cells.of_triangle[t] == kNoIndex, left_out[part.topology.component[t]] == 1);
  }
}

}  // namespace
}  // namespace atlas::test
