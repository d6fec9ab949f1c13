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

// Corners name the mesh's vertices in its own order; whole polygons cover in uv what their
// triangles cover, and these share uvs.
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

// No polygon is cut, and seams are at most so many times as long as those of the triangles alone.
// Charts are at most two more and a quarter more: how many there are is a matter of chance.
void expect_as_good(const PolygonShape& shape, double most_seams = 1.03,
                    const UnwrapOptions& options = {}) {
  const UnwrappedAtlas polygons = unwrap_all(with(shape.view()), options);
  const UnwrappedAtlas triangles = as_triangles(shape, options);
  const ChartSet &a = polygons.all().charts, &b = triangles.all().charts;
  expect_polygons(shape, polygons.mesh(0));
  EXPECT_EQ(polygons.mesh(0).cut_polygons.size(), 0u);
  EXPECT_LE(double(a.charts.size()), 2 + 1.25 * double(b.charts.size()));
  EXPECT_LE(a.seam_length, most_seams * b.seam_length);
  EXPECT_LE(a.distortion.stretch_999, options.charts.max_stretch);
  EXPECT_EQ(a.distortion.flips, 0u);
  EXPECT_GT(polygons.all().utilization, 0.85 * triangles.all().utilization);
}

std::size_t triangles_cut_by_seams(const PolygonShape& shape) {
  // How many polygons seams would run through if nothing kept them whole.
  const UnwrappedAtlas whole = unwrap_all(with(shape.view()));
  const UnwrappedAtlas free = as_triangles(shape);
  std::size_t cut = 0;
  const auto polygon = whole.mesh(0).triangle_polygon;
  const auto chart = free.mesh(0).triangle_chart;
  for (std::size_t t = 1; t < polygon.size(); ++t)
    cut += polygon[t] == polygon[t - 1] && chart[t] != chart[t - 1];
  return cut;
}

TEST(Polygons, ACubeOfSixQuadsStaysWhole) {
  expect_as_good(quads_of(box(1)));
  expect_as_good(quads_of(box(8)));
}

TEST(Polygons, ASphereOfQuadsStaysWhole) {
  EXPECT_GT(triangles_cut_by_seams(quads_of(sphere(64, 32))), 20u);
  expect_as_good(quads_of(sphere(64, 32)));
  expect_as_good(quads_of(sphere(96, 96)));
  expect_as_good(quads_of(torus(96, 48)));
  expect_as_good(quads_of(plate_with_holes(5, 6)));
}

// Every way along the sides of hexagons is at least 15 % longer than the straight one.
TEST(Polygons, TenThousandHexagonsStayWhole) {
  const PolygonShape sphere = dual_of(geodesic_sphere(32));
  ASSERT_GE(sphere.sizes.size(), 10000u);
  expect_as_good(sphere, 1.2);
  expect_as_good(dual_of(noisy(torus(128, 80), 0.003, 3)), 1.1);
}

// Walls of rectangles of all sizes, with corners of neighbours on their sides.
TEST(Polygons, TenThousandRectanglesStayWhole) {
  const PolygonShape walls = bricks(100, 100);
  ASSERT_EQ(walls.sizes.size(), 10000u);
  expect_as_good(walls, 1.1);
}

TEST(Polygons, PagesAreFilledWithoutCuttingPolygons) {
  UnwrapOptions square;
  square.square = true;
  expect_as_good(quads_of(cylinder(200, 20, 1, 0.1)), 1.03, square);
  expect_as_good(quads_of(grid(400, 10, 40, 1)), 1.03, square);
  // Limbs that leave the page empty are cut off between polygons.
  PolygonShape star = quads_of(grid(60, 3, 60, 3));
  const PolygonShape other = quads_of(grid(3, 60, 3, 60));
  const auto base = std::uint32_t(star.positions.size());
  for (const Vec3f& p : other.positions) star.positions.push_back({p.x + 28, p.y + 3, 0});
  for (const std::uint32_t v : other.indices) star.indices.push_back(base + v);
  star.sizes.insert(star.sizes.end(), other.sizes.begin(), other.sizes.end());
  const UnwrappedAtlas cut = unwrap_all(with(star.view()), square);
  EXPECT_GT(cut.all().charts.charts.size(), 1u);
  expect_polygons(star, cut.mesh(0));
  EXPECT_EQ(cut.mesh(0).cut_polygons.size(), 0u);
}

TEST(Polygons, ConcaveOnesAndThoseWithHolesStayWhole) {
  for (const PolygonShape& shape : {comb(1), comb(7), comb(200), frame()}) {
    const UnwrappedAtlas atlas = unwrap_all(with(shape.view()));
    EXPECT_EQ(atlas.all().charts.charts.size(), 1u);
    EXPECT_EQ(atlas.mesh(0).cut_polygons.size(), 0u);
    expect_polygons(shape, atlas.mesh(0));
  }
}

// Outlines that cross themselves, repeat corners or have no area: nothing is left out.
TEST(Polygons, BrokenOutlinesKeepTheirCorners) {
  PolygonShape shape;
  shape.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 1}, {0, 0, 5}};
  shape.add({0, 2, 1, 3});        // a bow tie
  shape.add({0, 1, 1, 2, 3});     // a corner twice in a row
  shape.add({0, 1, 2, 0, 4, 5});  // two triangles that share a corner
  shape.add({0, 1, 4, 1});        // a line
  shape.add({6, 6, 6, 6});        // a point
  shape.add({1, 4, 5, 2});        // not flat
  const UnwrappedAtlas atlas = unwrap_all(with(shape.view()));
  expect_polygons(shape, atlas.mesh(0));
  EXPECT_LE(atlas.mesh(0).cut_polygons.size(), 3u);
  for (const Vec2f uv : atlas.mesh(0).uvs)
    EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
}

// The side of a cone cannot lie flat in one piece; a polygon that winds around it is cut and named.
TEST(Polygons, OnesThatDoNotLieFlatAreCutAndNamed) {
  PolygonShape shape = quads_of(grid(2, 2));
  std::vector<std::uint32_t> ring;
  for (int k = 0; k < 12; ++k) {
    ring.push_back(std::uint32_t(shape.positions.size()));
    const double a = k * 2 * 3.14159265 / 12;
    shape.positions.push_back({float(std::cos(a)), float(std::sin(a)), k % 2 == 0 ? 10.0f : 12.0f});
  }
  shape.add(ring);
  const UnwrappedAtlas atlas = unwrap_all(with(shape.view()));
  const UnwrappedAtlas::Mesh mesh = atlas.mesh(0);
  expect_polygons(shape, mesh);
  ASSERT_EQ(mesh.cut_polygons.size(), 1u);
  EXPECT_EQ(mesh.cut_polygons[0], 4u);
  EXPECT_EQ(atlas.all().charts.distortion.flips, 0u);
}

TEST(Polygons, MeshesOfBothKindsShareAnAtlas) {
  const PolygonShape quads = quads_of(torus(32, 16));
  const Shape ball = icosphere(3);
  const StridedMesh triangles{.positions = {ball.positions.data(), ball.positions.size(), 0},
                              .indices = {ball.indices.data(), ball.indices.size(), 4}};
  for (const bool first : {true, false}) {
    Atlas atlas;
    ASSERT_TRUE(atlas.add(first ? quads.view() : triangles).ok());
    ASSERT_TRUE(atlas.add(first ? triangles : quads.view()).ok());
    ASSERT_TRUE(atlas.add(quads.view()).ok());
    const UnwrappedAtlas all = unwrap_all(atlas);
    for (const std::size_t i : {std::size_t{first ? 0u : 1u}, std::size_t{2}}) {
      expect_polygons(quads, all.mesh(i));
      EXPECT_EQ(all.mesh(i).cut_polygons.size(), 0u);
    }
    EXPECT_TRUE(all.mesh(first ? 1 : 0).polygon_corners.empty());
  }
}

TEST(Polygons, MaterialsDensitiesSeamsAndTexcoordsAreThoseOfPolygonsAndCorners) {
  const PolygonShape plate = quads_of(grid(4, 4));
  std::vector<std::uint32_t> materials(16, 0);
  materials[5] = 1;
  StridedMesh mesh = plate.view();
  mesh.materials = materials;
  EXPECT_EQ(unwrap_all(with(mesh)).all().charts.charts.size(), 2u);
  std::vector<std::uint8_t> seams(plate.indices.size(), 0);
  std::fill_n(seams.begin(), 4, std::uint8_t{1});  // around the first polygon
  mesh = plate.view();
  mesh.seams = seams;
  Atlas atlas = with(mesh);
  const UnwrappedAtlas cut = unwrap_all(atlas);
  EXPECT_EQ(cut.all().charts.charts.size(), 2u);
  const auto found = atlas.seams(cut, 0);
  ASSERT_TRUE(found.ok());
  ASSERT_EQ(found->size(), plate.indices.size());
  EXPECT_EQ(std::count(found->begin(), found->end(), 1), 4);  // two edges, from both sides
  std::vector<float> densities(16, 1);
  densities[0] = 2;
  mesh = plate.view();
  mesh.density = densities;
  const UnwrappedAtlas denser = unwrap_all(with(mesh));
  const auto corners = denser.mesh(0).polygon_corners;
  EXPECT_GT(twice_area(denser.mesh(0), corners.subspan(0, 4)),
            2 * twice_area(denser.mesh(0), corners.subspan(4 * 15, 4)));
  // Given uvs, one a corner: each polygon apart.
  std::vector<Vec2f> texcoords;
  std::vector<std::uint32_t> of_corner;
  for (std::size_t p = 0; p < 16; ++p)
    for (const auto& [x, y] : {std::pair(0.f, 0.f), {1.f, 0.f}, {1.f, 1.f}, {0.f, 1.f}}) {
      of_corner.push_back(std::uint32_t(texcoords.size()));
      texcoords.push_back({float(p) * 2 + x, y});
    }
  mesh = plate.view();
  mesh.texcoords = {texcoords.data(), texcoords.size(), 0};
  mesh.texcoord_indices = {of_corner.data(), of_corner.size(), 4};
  const UnwrappedAtlas kept = unwrap_all(with(mesh), {{}, {.keep_uv_charts = true}});
  EXPECT_EQ(kept.all().charts.repairs.kept_charts, 16u);
  EXPECT_EQ(kept.mesh(0).cut_polygons.size(), 0u);
}

TEST(Polygons, TheResultDoesNotDependOnTheOrderOfPolygons) {
  const PolygonShape shape = quads_of(torus(40, 20));
  PolygonShape turned;
  turned.positions = shape.positions;
  for (std::size_t p = shape.sizes.size(); p-- > 0;)
    turned.add({shape.indices.begin() + std::ptrdiff_t(4 * p),
                shape.indices.begin() + std::ptrdiff_t(4 * p + 4)});
  const UnwrappedAtlas a = unwrap_all(with(shape.view())), b = unwrap_all(with(turned.view()));
  EXPECT_EQ(a.all().charts.charts.size(), b.all().charts.charts.size());
  EXPECT_EQ(a.all().charts.seam_length, b.all().charts.seam_length);
}

TEST(Polygons, UnusableOnesAreRefusedByNumber) {
  const PolygonShape plate = quads_of(grid(2, 2));
  const std::vector<std::uint32_t> small{4, 2, 4, 6}, few{4, 4, 4}, many{4, 4, 4, 5};
  const std::vector<float> densities{1, 0, 1, 1}, short_densities{1, 1, 1};
  std::vector<std::uint32_t> beyond = plate.indices, again(70 * 2, 0);
  beyond[9] = 99;
  for (std::size_t i = 0; i < again.size(); ++i) again[i] = std::uint32_t(i % 2);
  const std::vector<std::uint32_t> all{140}, numbers{0, 0, 1, 1};
  std::vector<Vec3f> far = plate.positions;
  far[plate.indices[10]].y = std::numeric_limits<float>::quiet_NaN();
  struct Case {
    StridedMesh mesh;
    const char* message;
  };
  std::vector<Case> cases(9, {plate.view(), ""});
  cases[0].mesh.polygon_sizes = small, cases[0].message = "mesh 0: polygon 1: 2 corners";
  cases[1].mesh.polygon_sizes = few, cases[1].message = "3 polygons have 12 corners in all";
  cases[2].mesh.polygon_sizes = many, cases[2].message = "4 polygons have 17 corners in all";
  cases[3].mesh.density = densities, cases[3].message = "mesh 0: polygon 1: density 0";
  cases[4].mesh.density = short_densities, cases[4].message = "3 densities for 4 polygons";
  cases[5].mesh.indices.data = beyond.data(), cases[5].message = "polygon 2: vertex index 99";
  cases[6].mesh.positions.data = far.data(), cases[6].message = "position that is not finite";
  cases[7].mesh.indices = {again.data(), again.size(), 4};
  cases[7].mesh.polygon_sizes = all, cases[7].message = "mesh 0: polygon 0: it names its vertices";
  cases[8].mesh.polygons = numbers, cases[8].message = "4 polygon numbers for 4 polygons";
  Atlas atlas;
  for (const Case& c : cases) {
    const auto added = atlas.add(c.mesh);
    EXPECT_EQ(added.status().code(), ErrorCode::bad_input) << c.message;
    EXPECT_NE(added.status().message().find(c.message), std::string::npos)
        << added.status().message();
  }
  EXPECT_EQ(atlas.mesh_count(), 0u);
  ASSERT_TRUE(atlas.add(plate.view()).ok());
  expect_polygons(plate, unwrap_all(atlas).mesh(0));
}

}  // namespace
}  // namespace atlas::test
