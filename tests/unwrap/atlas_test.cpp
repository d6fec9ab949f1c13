// Several meshes on one atlas: each gets its own back, none is joined to another, and none lies on
// another.
#include "libatlas/unwrap/atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/atlas_measure.h"
#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

UnwrappedAtlas unwrapped(const Atlas& atlas, const UnwrapOptions& options = {},
                         const Context& context = {}) {
  auto result = atlas.unwrap(options, context);
  EXPECT_TRUE(result.ok()) << result.status().message();
  return std::move(*result);
}

Atlas atlas_of(const std::vector<Shape>& shapes) {
  Atlas atlas;
  for (const Shape& shape : shapes) {
    const auto number = atlas.add(view_of(shape));
    EXPECT_TRUE(number.ok()) << number.status().message();
    EXPECT_EQ(*number, atlas.mesh_count() - 1);
  }
  return atlas;
}

// Vertices and triangles are those of the mesh itself, in its order.
void expect_own(const Shape& shape, const UnwrappedAtlas::Mesh& mesh) {
  ASSERT_EQ(mesh.indices.size(), shape.indices.size());
  ASSERT_EQ(mesh.triangle_page.size(), shape.triangle_count());
  ASSERT_EQ(mesh.triangle_chart.size(), shape.triangle_count());
  ASSERT_EQ(mesh.uvs.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    ASSERT_LT(mesh.indices[i], mesh.vertices.size());
    ASSERT_EQ(mesh.vertices[mesh.indices[i]], shape.indices[i]) << "corner " << i;
  }
}

// Measures all meshes together, as a renderer would draw them.
AtlasMeasures measured(const std::vector<Shape>& shapes, const UnwrappedAtlas& atlas) {
  UvMesh all;
  all.pages = std::uint32_t(atlas.all().pages.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const UnwrappedAtlas::Mesh mesh = atlas.mesh(i);
    const auto first = std::uint32_t(all.positions.size()),
               first_uv = std::uint32_t(all.uvs.size());
    // Apart, so that seams of the oracle are those of each mesh.
    for (const Vec3f p : shapes[i].positions)
      all.positions.push_back({p.x + 100.0 * double(i), p.y, p.z});
    for (const Vec2f uv : mesh.uvs) all.uvs.push_back({uv.x, uv.y});
    for (std::size_t t = 0; t < mesh.triangle_page.size(); ++t) {
      UvMesh::Face face{{}, {}, mesh.triangle_page[t]};
      for (std::size_t k = 0; k < 3; ++k) {
        face.position[k] = first + shapes[i].indices[3 * t + k];
        face.uv[k] = first_uv + mesh.indices[3 * t + k];
      }
      all.faces.push_back(face);
    }
  }
  const Extent page = atlas.all().pages[0];
  return measure_atlas(all, page.width, page.height);
}

const std::vector<Shape>& three_shapes() {
  static const std::vector<Shape> shapes{torus(32, 16), box(4), icosphere(3)};
  return shapes;
}

TEST(Atlas, OneMeshIsUnwrappedAsByUnwrapMesh) {
  for (const Shape& shape : three_shapes()) {
    const auto alone = unwrap_mesh(view_of(shape), {}, {});
    ASSERT_TRUE(alone.ok());
    const UnwrappedAtlas atlas = unwrapped(atlas_of({shape}));
    const UnwrappedAtlas::Mesh mesh = atlas.mesh(0);
    EXPECT_TRUE(std::ranges::equal(mesh.vertices, alone->vertices));
    EXPECT_TRUE(std::ranges::equal(mesh.uvs, alone->uvs));
    EXPECT_TRUE(std::ranges::equal(mesh.indices, alone->indices));
    EXPECT_TRUE(std::ranges::equal(mesh.triangle_page, alone->triangle_page));
    EXPECT_EQ(atlas.all().utilization, alone->utilization);
  }
}

TEST(Atlas, MeshesGetTheirOwnBackAndDoNotLieOnEachOther) {
  const UnwrappedAtlas atlas = unwrapped(atlas_of(three_shapes()), {{.page_size = 512}});
  ASSERT_EQ(atlas.mesh_count(), 3u);
  for (std::size_t i = 0; i < 3; ++i) expect_own(three_shapes()[i], atlas.mesh(i));
  const AtlasMeasures measures = measured(three_shapes(), atlas);
  EXPECT_EQ(measures.overlap, 0u);
  EXPECT_EQ(measures.flipped, 0u);
  EXPECT_EQ(measures.bleed, 0u);
  EXPECT_EQ(measures.charts, atlas.all().charts.charts.size());
  EXPECT_NEAR(measures.utilization, atlas.all().utilization, 1e-3);
  EXPECT_GT(measures.utilization, 0.5);
}

// Two halves of a plate that touch, and two plates at the same place.
TEST(Atlas, MeshesThatTouchOrCoincideAreNotJoined) {
  const Shape left = grid(8, 8), right = moved(grid(8, 8), 1, {1, 0, 0});
  const UnwrappedAtlas atlas = unwrapped(atlas_of({left, right, left}));
  const ChartSet& charts = atlas.all().charts;
  EXPECT_EQ(charts.charts.size(), 3u);
  EXPECT_EQ(charts.seam_length, 0);  // borders of meshes are no seams
  EXPECT_EQ(charts.repairs.nonmanifold_edges, 0u);
  EXPECT_EQ(charts.repairs.duplicate_triangles, 0u);
  std::set<std::size_t> meshes;
  for (std::size_t c = 0; c < charts.charts.size(); ++c) meshes.insert(atlas.mesh_of_chart(c));
  EXPECT_EQ(meshes.size(), 3u);
  // As one mesh, the halves are a chart, unless they are two objects.
  const Shape both = together(left, right);
  EXPECT_EQ(unwrapped(atlas_of({both})).all().charts.charts.size(), 1u);
  std::vector<std::uint32_t> objects(both.positions.size(), 5);
  std::fill_n(objects.begin(), left.positions.size(), 9);
  MeshView apart = view_of(both);
  apart.objects = objects;
  Atlas atlas_of_objects;
  ASSERT_TRUE(atlas_of_objects.add(apart).ok());
  EXPECT_EQ(unwrapped(atlas_of_objects).all().charts.charts.size(), 2u);
}

// A triangle without area that touches nothing lies in a chart of its own mesh.
TEST(Atlas, TrianglesWithoutAreaStayInTheirMesh) {
  Shape point = grid(2, 2);
  point.positions.assign(point.positions.size(), Vec3f{0.5f, 0.5f, 7});
  const UnwrappedAtlas atlas = unwrapped(atlas_of({grid(4, 4), point, grid(3, 3)}));
  for (std::size_t i = 0; i < 3; ++i)
    for (const std::uint32_t chart : atlas.mesh(i).triangle_chart)
      EXPECT_EQ(atlas.mesh_of_chart(chart), i);
}

TEST(Atlas, TheOrderOfMeshesDoesNotChangeTheQuality) {
  const auto& shapes = three_shapes();
  const UnwrappedAtlas one = unwrapped(atlas_of(shapes)),
                       other = unwrapped(atlas_of({shapes[2], shapes[0], shapes[1]}));
  const ChartSet &a = one.all().charts, &b = other.all().charts;
  EXPECT_EQ(a.charts.size(), b.charts.size());
  EXPECT_NEAR(a.seam_length, b.seam_length, 0.02 * a.seam_length);
  EXPECT_NEAR(a.distortion.stretch_l2, b.distortion.stretch_l2, 1e-3);
  EXPECT_NEAR(one.all().utilization, other.all().utilization, 0.03);
}

TEST(Atlas, TheResultIsTheSameForAnyNumberOfThreads) {
  const Atlas atlas = atlas_of(three_shapes());
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  const UnwrappedAtlas a = unwrapped(atlas, {}, one), b = unwrapped(atlas, {}, four);
  EXPECT_EQ(a.all().uvs, b.all().uvs);
  EXPECT_EQ(a.all().indices, b.all().indices);
}

TEST(Atlas, StridesAndNarrowIndicesGiveTheSame) {
  const Shape shape = torus(24, 12);
  struct Vertex {
    float normal[3];
    Vec3f position;
    std::uint8_t color[3];
  };
  std::vector<Vertex> vertices;
  for (const Vec3f p : shape.positions) vertices.push_back({{}, p, {}});
  std::vector<std::uint16_t> indices(shape.indices.begin(), shape.indices.end());
  // Packed as in a file: not aligned.
  std::vector<unsigned char> packed(1 + 13 * shape.positions.size());
  for (std::size_t v = 0; v < shape.positions.size(); ++v)
    std::memcpy(&packed[1 + 13 * v], &shape.positions[v], sizeof(Vec3f));

  const UnwrappedAtlas plain = unwrapped(atlas_of({shape}));
  const StridedSpan<Vec3f> interleaved{&vertices[0].position, vertices.size(), sizeof(Vertex)},
      unaligned{&packed[1], shape.positions.size(), 13};
  for (const StridedSpan<Vec3f>& positions : {interleaved, unaligned}) {
    Atlas atlas;
    ASSERT_TRUE(
        atlas.add({.positions = positions, .indices = {indices.data(), indices.size(), 2}}).ok());
    EXPECT_EQ(unwrapped(atlas).all().uvs, plain.all().uvs);
  }
}

double texels(const UnwrappedAtlas& atlas, std::size_t i) {
  const UnwrappedAtlas::Mesh mesh = atlas.mesh(i);
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangle_page.size(); ++t) {
    const Vec2f a = mesh.uvs[mesh.indices[3 * t]], b = mesh.uvs[mesh.indices[3 * t + 1]],
                c = mesh.uvs[mesh.indices[3 * t + 2]];
    area += std::abs((double(b.x) - a.x) * (double(c.y) - a.y) -
                     (double(b.y) - a.y) * (double(c.x) - a.x)) /
            2 * double(atlas.all().pages[mesh.triangle_page[t]].area());
  }
  return area;
}

TEST(Atlas, DensityIsThatOfAMeshAndOfItsTriangles) {
  const Shape plate = grid(6, 6);
  const std::vector<float> own(plate.triangle_count(), 3);
  MeshView denser = view_of(plate);
  denser.density = own;
  Atlas atlas;
  ASSERT_TRUE(atlas.add(view_of(plate)).ok());
  ASSERT_TRUE(atlas.add(view_of(plate), 2).ok());
  ASSERT_TRUE(atlas.add(denser, 0.5f).ok());
  const UnwrappedAtlas result = unwrapped(atlas);
  EXPECT_NEAR(texels(result, 1) / texels(result, 0), 4, 0.01);
  EXPECT_NEAR(texels(result, 2) / texels(result, 0), 2.25, 0.01);
}

TEST(Atlas, MaterialsAndMarkedSeamsAreThoseOfTheirMesh) {
  const Shape plate = grid(4, 4);
  std::vector<std::uint32_t> materials(plate.triangle_count(), 0);
  for (std::size_t t = 0; t < materials.size() / 2; ++t) materials[t] = 7;
  std::vector<std::uint8_t> seams(plate.indices.size(), 1);
  MeshView painted = view_of(plate), cut = view_of(plate);
  painted.materials = materials;
  cut.seams = seams;
  Atlas atlas;
  for (const MeshView& mesh : {view_of(plate), painted, view_of(plate), cut})
    ASSERT_TRUE(atlas.add(mesh).ok());
  const UnwrappedAtlas result = unwrapped(atlas);
  std::vector<std::size_t> charts(4);
  for (std::size_t c = 0; c < result.all().charts.charts.size(); ++c)
    ++charts[result.mesh_of_chart(c)];
  EXPECT_EQ(charts, (std::vector<std::size_t>{1, 2, 1, plate.triangle_count()}));
}

// A roof of two plates with a ridge, whose vertices have one normal, or one for each side.
TEST(Atlas, EdgesAtWhichNormalsDifferAreSeams) {
  const Shape left = grid(4, 4);
  Shape right = moved(grid(4, 4), 1, {1, 0, 0});
  for (Vec3f& p : right.positions) p.z = 0.1f * (p.x - 1);
  const Shape roof = together(left, right);
  std::vector<Vec3f> normals(roof.positions.size(), {0, 0, 1});
  const auto charts = [&] {
    const StridedMesh mesh{.positions = {roof.positions.data(), roof.positions.size(), 0},
                           .indices = {roof.indices.data(), roof.indices.size(), 4},
                           .normals = {normals.data(), normals.size(), 0}};
    Atlas atlas;
    EXPECT_TRUE(atlas.add(mesh).ok());
    return unwrapped(atlas).all().charts.charts.size();
  };
  EXPECT_EQ(charts(), 1u);
  std::fill_n(normals.begin(), left.positions.size(), Vec3f{-0.1f, 0, 1});
  EXPECT_EQ(charts(), 2u);
}

TEST(Atlas, GivenUvsAreKeptWhereAMeshHasThem) {
  const Shape plate = grid(4, 4);
  std::vector<Vec2f> uvs;
  for (const Vec3f p : plate.positions) uvs.push_back({p.x, p.y});
  MeshView given = view_of(plate);
  given.texcoords = uvs;
  Atlas atlas;
  ASSERT_TRUE(atlas.add(view_of(box(2))).ok());
  ASSERT_TRUE(atlas.add(given).ok());
  const UnwrappedAtlas result = unwrapped(atlas, {{}, {.keep_uv_charts = true}});
  EXPECT_EQ(result.all().charts.repairs.kept_charts, 1u);
  for (std::size_t c = 0; c < result.all().charts.charts.size(); ++c)
    EXPECT_EQ(result.all().charts.charts[c].kept, result.mesh_of_chart(c) == 1);
}

TEST(Atlas, SeamsAreTheEdgesThatHaveSeveralUvs) {
  const std::vector<Shape> shapes{grid(4, 4), box(3)};
  const Atlas atlas = atlas_of(shapes);
  const UnwrappedAtlas result = unwrapped(atlas);
  const auto flat = atlas.seams(result, 0), cube = atlas.seams(result, 1);
  ASSERT_TRUE(flat.ok() && cube.ok());
  EXPECT_EQ(std::set<std::uint8_t>(flat->begin(), flat->end()), std::set<std::uint8_t>{0});
  double length = 0;
  for (std::size_t h = 0; h < cube->size(); ++h) {
    if (!(*cube)[h]) continue;
    const Vec3f a = shapes[1].positions[shapes[1].indices[h]],
                b = shapes[1].positions[shapes[1].indices[h % 3 == 2 ? h - 2 : h + 1]];
    length += std::hypot(b.x - a.x, b.y - a.y, b.z - a.z) / 2;  // both sides
  }
  EXPECT_GT(length, 4.9);  // a cube comes apart along five edges
  EXPECT_NEAR(length, result.all().charts.seam_length, 1e-5);
  EXPECT_EQ(atlas.seams(result, 2).status().code(), ErrorCode::bad_input);
  EXPECT_EQ(atlas_of({box(2)}).seams(result, 0).status().code(), ErrorCode::bad_input);
}

TEST(Atlas, CanBeCancelled) {
  std::atomic<bool> cancel = false;
  Context context;
  context.cancel = &cancel;
  context.progress = [&](std::string_view, double fraction) { cancel = fraction > 0; };
  EXPECT_EQ(atlas_of(three_shapes()).unwrap({}, context).status().code(), ErrorCode::cancelled);
}

TEST(Atlas, UnusableMeshesAreRefusedByNameAndLeaveTheAtlasAsItWas) {
  const Shape plate = grid(2, 2);
  const std::vector<float> densities{1, 2, 3};
  const std::vector<std::uint32_t> materials{1};
  std::vector<Vec3f> far = plate.positions;
  far[plate.indices[9]].x = std::numeric_limits<float>::infinity();
  const std::vector<std::uint32_t> beyond{0, 1, 2, 0, 1, 9};
  const StridedMesh good{.positions = {plate.positions.data(), plate.positions.size(), 0},
                         .indices = {plate.indices.data(), plate.indices.size(), 4}};
  struct Case {
    StridedMesh mesh;
    float density;
    const char* message;
  };
  std::vector<Case> cases(12, {good, 1, ""});
  cases[0].mesh.positions.stride = 8, cases[0].message = "mesh 1: positions lie 8 bytes apart";
  cases[1].mesh.indices.bytes = 3, cases[1].message = "mesh 1: indices have 3 bytes";
  cases[2].mesh.indices = {beyond.data(), 6, 4};
  cases[2].message = "mesh 1: triangle 1: vertex index 9 names none of the 9";
  cases[3].mesh.indices.count = 0, cases[3].message = "mesh 1: no triangle";
  cases[4].mesh.indices.count = 7, cases[4].message = "mesh 1: 7 indices are not whole";
  cases[5].mesh.positions.data = nullptr, cases[5].message = "mesh 1: positions are null";
  cases[6].mesh.density = densities, cases[6].message = "mesh 1: 3 densities for 8 triangles";
  cases[7].mesh.materials = materials, cases[7].message = "mesh 1: 1 materials for 8";
  cases[8].density = 0, cases[8].message = "mesh 1: density 0";
  cases[9].density = NAN, cases[9].message = "mesh 1: density nan";
  cases[10].mesh.positions.data = far.data(), cases[10].message = "position that is not finite";
  cases[11].mesh.texcoords = {plate.positions.data(), 4, 0};
  cases[11].message = "mesh 1: 4 texcoords for 9 positions";
  Atlas atlas = atlas_of({plate});
  for (const Case& c : cases) {
    const auto added = atlas.add(c.mesh, c.density);
    EXPECT_EQ(added.status().code(), ErrorCode::bad_input);
    EXPECT_NE(added.status().message().find(c.message), std::string::npos)
        << added.status().message();
  }
  EXPECT_EQ(atlas.mesh_count(), 1u);
  EXPECT_EQ(unwrapped(atlas).all().uvs, unwrapped(atlas_of({plate})).all().uvs);
  EXPECT_EQ(Atlas().unwrap({}, {}).status().code(), ErrorCode::bad_input);
}

TEST(Atlas, LightmapsAreSquareWithGapsAndTheDensityAskedFor) {
  const Atlas atlas = atlas_of({moved(box(2), 100)});  // a metre in centimetres
  const UnwrappedAtlas result = unwrapped(atlas, lightmap_options(64, 0.01));
  EXPECT_NEAR(result.all().texels_per_unit, 0.64, 1e-9);
  EXPECT_NEAR(texels(result, 0), 6 * 64 * 64, 0.001 * 6 * 64 * 64);
  const Extent page = result.all().pages[0];
  EXPECT_EQ(page.width, page.height);
  EXPECT_TRUE(std::has_single_bit(std::uint32_t(page.width)));
  EXPECT_EQ(result.all().texels_drawn_twice, 0u);
  EXPECT_EQ(atlas.unwrap(lightmap_options(-1), {}).status().code(), ErrorCode::bad_option);
}

}  // namespace
}  // namespace atlas::test
