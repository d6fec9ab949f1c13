// Polygons come back with uvs per corner in their own order, and no seam runs inside one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/predicates.h"
#include "libatlas/unwrap/atlas.h"
#include "tests/unwrap/polygon_shapes.h"

namespace atlas::test {
namespace {

UnwrappedAtlas unwrap_all(const Atlas& atlas, const UnwrapOptions& options = {}) {
  auto result = atlas.unwrap(options, {});
  EXPECT_TRUE(result.ok()) << result.status().message();
  return std::move(*result);
}

Atlas with(const StridedMesh& mesh) {
  Atlas atlas;
  const auto added = atlas.add(mesh);
  EXPECT_TRUE(added.ok()) << added.status().message();
  return atlas;
}

// The same triangles without their polygons.
UnwrappedAtlas as_triangles(const PolygonShape& shape, const UnwrapOptions& options = {}) {
  const UnwrappedAtlas whole = unwrap_all(with(shape.view()));
  std::vector<std::uint32_t> indices;
  for (const std::uint32_t v : whole.mesh(0).indices) indices.push_back(whole.mesh(0).vertices[v]);
  StridedMesh mesh = shape.view();
  mesh.indices = {indices.data(), indices.size(), 4};
  mesh.polygon_sizes = {};
  return unwrap_all(with(mesh), options);
}

double twice_area(const UnwrappedAtlas::Mesh& mesh, std::span<const std::uint32_t> corners) {
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2f a = mesh.uvs[corners[i]], b = mesh.uvs[corners[(i + 1) % corners.size()]];
    area += double{a.x} * b.y - double{a.y} * b.x;
  }
  return area;
}

// Corners name the mesh's vertices in its own order; whole polygons cover in uv what their triangles
// cover, and these share uvs.
void expect_polygons(const PolygonShape& shape, const UnwrappedAtlas::Mesh& mesh) {
  ASSERT_EQ(mesh.polygon_corners.size(), shape.indices.size());
  for (std::size_t i = 0; i < shape.indices.size(); ++i)
    ASSERT_EQ(mesh.vertices[mesh.polygon_corners[i]], shape.indices[i]) << "corner " << i;
  std::size_t triangle = 0, corner = 0;
  for (std::size_t p = 0; p < shape.sizes.size(); ++p) {
    const std::size_t size = shape.sizes[p];
    const auto corners = mesh.polygon_corners.subspan(corner, size);
    double area = 0;
    bool whole = true;
    for (std::size_t k = 0; k < size - 2; ++k, ++triangle) {
      ASSERT_EQ(mesh.triangle_polygon[triangle], p);
      const auto own = mesh.indices.subspan(3 * triangle, 3);
      area += twice_area(mesh, own);
      for (const std::uint32_t v : own)
        whole = whole && std::ranges::find(corners, v) != corners.end();
    }
    corner += size;
    EXPECT_EQ(std::ranges::binary_search(mesh.cut_polygons, std::uint32_t(p)), !whole) << p;
    if (whole) {
      EXPECT_NEAR(twice_area(mesh, corners), area, 1e-6) << "polygon " << p;
    }
  }
  EXPECT_EQ(triangle, mesh.triangle_polygon.size());
}

// No more charts and seams than 3 % above those of the triangles alone, and no polygon cut.
void expect_as_good(const PolygonShape& shape, const UnwrapOptions& options = {}) {
  const UnwrappedAtlas polygons = unwrap_all(with(shape.view()), options);
  const UnwrappedAtlas triangles = as_triangles(shape, options);
  const ChartSet &a = polygons.all().charts, &b = triangles.all().charts;
  expect_polygons(shape, polygons.mesh(0));
  EXPECT_EQ(polygons.mesh(0).cut_polygons.size(), 0u);
  EXPECT_LE(double(a.charts.size()), 1.03 * double(b.charts.size()));
  EXPECT_LE(a.seam_length, 1.03 * b.seam_length);
  printf("charts %zu %zu seams %g %g l2 %g %g util %g %g\n", a.charts.size(), b.charts.size(),
         a.seam_length, b.seam_length, a.distortion.stretch_l2, b.distortion.stretch_l2,
         polygons.all().utilization, triangles.all().utilization);
  EXPECT_LE(a.distortion.stretch_999, options.charts.max_stretch);
  EXPECT_EQ(polygons.all().texels_drawn_twice, triangles.all().texels_drawn_twice);
}

TEST(Polygons, ACubeOfSixQuadsStaysWhole) {
  expect_as_good(quads_of(box(1)));
  expect_as_good(quads_of(box(8)));
}

TEST(Polygons, ASphereOfQuadsStaysWhole) {
  expect_as_good(quads_of(sphere(64, 32)));
  expect_as_good(quads_of(sphere(96, 96)));
}
TEST(Polygons, ATorusOfQuadsStaysWhole) { expect_as_good(quads_of(torus(96, 48))); }
TEST(Polygons, ManyNgonsStayWhole) {
  const PolygonShape ngons = dual_of(geodesic_sphere(32));
  ASSERT_GE(ngons.sizes.size(), 10000u);
  expect_as_good(ngons);
  expect_as_good(dual_of(noisy(torus(128, 80), 0.003, 3)));
}
TEST(Polygons, PartsWithHolesStayWhole) {
  expect_as_good(quads_of(plate_with_holes(5, 6)));
}
TEST(Polygons, PagesAreFilledWithoutCuttingPolygons) {
  UnwrapOptions square;
  square.square = true;
  expect_as_good(quads_of(cylinder(200, 20, 1, 0.1)), square);
  expect_as_good(quads_of(grid(400, 10, 40, 1)), square);
}

}  // namespace
}  // namespace atlas::test
