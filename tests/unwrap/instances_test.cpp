// Instances: a mesh is unwrapped once, and each instance has a place and a scale of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/unwrap/atlas.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

struct Placed {
  Shape shape;
  std::vector<float> densities;  // none: added once
};

Atlas atlas_with(const std::vector<Placed>& meshes) {
  Atlas atlas;
  for (const Placed& mesh : meshes) {
    const auto added =
        mesh.densities.empty()
            ? atlas.add(view_of(mesh.shape))
            : atlas.add_instances(view_of(mesh.shape), mesh.densities.size(), mesh.densities);
    EXPECT_TRUE(added.ok()) << added.status().message();
  }
  return atlas;
}

UnwrappedAtlas placed_on_pages(const Atlas& atlas, const UnwrapOptions& options = {}) {
  auto result = atlas.unwrap(options, {});
  EXPECT_TRUE(result.ok()) << result.status().message();
  return std::move(*result);
}

// All instances as a renderer draws them.
UvMesh drawn(const std::vector<Placed>& meshes, const UnwrappedAtlas& atlas) {
  UvMesh all;
  all.pages = std::uint32_t(atlas.all().pages.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const UnwrappedAtlas::Mesh mesh = atlas.mesh(i);
    const std::size_t count = std::max<std::size_t>(1, mesh.instances.size());
    for (std::size_t k = 0; k < count; ++k) {
      const auto first = std::uint32_t(all.positions.size()),
                 first_uv = std::uint32_t(all.uvs.size());
      for (const Vec3f p : meshes[i].shape.positions)
        all.positions.push_back({p.x + 100.0 * double(i), p.y + 100.0 * double(k), p.z});
      for (const Vec2f uv : mesh.uvs) {
        const MeshInstance at = mesh.instances.empty() ? MeshInstance{} : mesh.instances[k];
        all.uvs.push_back({at.offset.x + uv.x * at.scale.x, at.offset.y + uv.y * at.scale.y});
      }
      for (std::size_t t = 0; t < mesh.triangle_page.size(); ++t) {
        UvMesh::Face face{
            {}, {}, mesh.instances.empty() ? mesh.triangle_page[t] : mesh.instances[k].page};
        for (std::size_t c = 0; c < 3; ++c) {
          face.position[c] = first + meshes[i].shape.indices[3 * t + c];
          face.uv[c] = first_uv + mesh.indices[3 * t + c];
        }
        all.faces.push_back(face);
      }
    }
  }
  return all;
}

void expect_apart(const std::vector<Placed>& meshes, const UnwrappedAtlas& atlas) {
  for (const Extent& page : atlas.all().pages) ASSERT_EQ(page, atlas.all().pages[0]);
  const Extent page = atlas.all().pages[0];
  const AtlasMeasures measures = measure_atlas(drawn(meshes, atlas), page.width, page.height);
  EXPECT_EQ(measures.overlap, 0u);
  EXPECT_EQ(measures.flipped, 0u);
  EXPECT_EQ(measures.bleed, 0u);
  EXPECT_NEAR(measures.utilization, atlas.all().utilization, 2e-3);
}

TEST(Instances, AreUnwrappedOnceAndLieApart) {
  const std::vector<Placed> meshes{
      {torus(24, 12), std::vector<float>(20, 1)}, {box(3), {1, 2, 0.5f}}, {icosphere(2), {}}};
  for (const UnwrapOptions& options :
       {UnwrapOptions{{.page_size = 1024}}, UnwrapOptions{{.pages = 3, .page_size = 512}},
        lightmap_options(0)}) {
    const UnwrappedAtlas atlas = placed_on_pages(atlas_with(meshes), options);
    EXPECT_LE(atlas.all().pages.size(), options.pages);
    ASSERT_EQ(atlas.mesh(0).instances.size(), 20u);
    ASSERT_EQ(atlas.mesh(1).instances.size(), 3u);
    EXPECT_TRUE(atlas.mesh(2).instances.empty());
    expect_apart(meshes, atlas);
    EXPECT_GT(atlas.all().utilization, 0.25);
    // Scales are those of the densities.
    const auto boxes = atlas.mesh(1).instances;
    EXPECT_NEAR(boxes[1].scale.x / boxes[0].scale.x, 2, 1e-5);
    EXPECT_NEAR(boxes[2].scale.y / boxes[0].scale.y, 0.5, 1e-5);
    for (const MeshInstance& at : atlas.mesh(0).instances)
      EXPECT_EQ(at.scale, atlas.mesh(0).instances[0].scale);
    for (const Vec2f uv : atlas.mesh(0).uvs)
      EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
  }
}

TEST(Instances, HaveTheDensityAskedFor) {
  const std::vector<Placed> meshes{{grid(4, 4), {1, 1, 2}}, {grid(2, 2), {}}};
  UnwrapOptions options{{.page_size = 1024}};
  options.texels_per_unit = 100;
  const UnwrappedAtlas atlas = placed_on_pages(atlas_with(meshes), options);
  EXPECT_NEAR(atlas.all().texels_per_unit, 100, 1e-9);
  expect_apart(meshes, atlas);
  const Extent page = atlas.all().pages[0];
  const auto width = [&](std::size_t mesh, float scale) {
    const auto [low, high] = std::ranges::minmax(atlas.mesh(mesh).uvs, {}, &Vec2f::x);
    return (high.x - low.x) * scale * float(page.width);
  };
  EXPECT_NEAR(width(0, atlas.mesh(0).instances[0].scale.x), 100, 1.5);
  EXPECT_NEAR(width(0, atlas.mesh(0).instances[2].scale.x), 200, 3);
  EXPECT_NEAR(width(1, 1), 100, 1.5);
  // What pages do not hold gets less.
  options.page_size = 64;
  const UnwrappedAtlas small = placed_on_pages(atlas_with(meshes), options);
  EXPECT_LT(small.all().texels_per_unit, 30);
  expect_apart(meshes, small);
}

// The placements say where charts are, so that light can be baked there.
TEST(Instances, PlacementsAreThoseOfTheFirstOne) {
  const std::vector<Placed> meshes{{torus(24, 12), {2, 1}}, {box(2), {}}};
  const UnwrappedAtlas atlas = placed_on_pages(atlas_with(meshes), {{.page_size = 512}});
  const UnwrappedMesh& all = atlas.all();
  ASSERT_EQ(all.placements.size(), all.charts.charts.size());
  for (std::size_t i = 0, t = 0; i < 2; ++i) {
    const UnwrappedAtlas::Mesh mesh = atlas.mesh(i);
    const MeshInstance at = i == 0 ? mesh.instances[0] : MeshInstance{};
    for (std::size_t own = 0; own < mesh.triangle_page.size(); ++own, ++t) {
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec2f uv = mesh.uvs[mesh.indices[3 * own + c]];
        const Vec2d chart_place = all.charts.uvs[all.charts.triangle_uv[3 * t + c]];
        const Vec2d expected =
            page_texel(all.placements[all.charts.triangle_chart[t]], chart_place);
        EXPECT_NEAR((at.offset.x + uv.x * at.scale.x) * all.pages[0].width, expected.x, 0.3);
        EXPECT_NEAR((at.offset.y + uv.y * at.scale.y) * all.pages[0].height, expected.y, 0.3);
      }
    }
  }
}

TEST(Instances, UnusableOnesAreRefusedByNumber) {
  const Shape plate = grid(2, 2);
  Atlas atlas;
  const auto refused = [&](std::size_t count, const std::vector<float>& densities,
                           const char* message) {
    const auto added = atlas.add_instances(view_of(plate), count, densities);
    EXPECT_EQ(added.status().code(), ErrorCode::bad_input);
    EXPECT_NE(added.status().message().find(message), std::string::npos)
        << added.status().message();
  };
  refused(0, {}, "mesh 0: no instance");
  refused(2, {1}, "mesh 0: 1 densities for 2 instances");
  refused(3, {1, 1, 0}, "mesh 0: instance 2: density 0");
  refused(2, {1, std::numeric_limits<float>::quiet_NaN()}, "mesh 0: instance 1: density nan");
  refused(1, {-1}, "instance 0: density -1");
  EXPECT_EQ(atlas.add_instances(view_of(plate), std::size_t{1} << 40).status().code(),
            ErrorCode::unsupported);
  MeshView broken = view_of(plate);
  broken.indices = broken.indices.subspan(0, 4);
  EXPECT_EQ(atlas.add_instances(broken, 2).status().code(), ErrorCode::bad_input);
  EXPECT_EQ(atlas.mesh_count(), 0u);
  ASSERT_TRUE(atlas.add_instances(view_of(plate), 5000).ok());
  UnwrapOptions options{{.page_size = 256}};
  EXPECT_EQ(atlas.unwrap(options, {}).status().code(), ErrorCode::no_solution);
  options.page_size = 1;
  EXPECT_EQ(atlas.unwrap(options, {}).status().code(), ErrorCode::bad_option);
}

// Where gutters alone are too much, a lower density is of no use, and is not tried over and over.
TEST(Instances, GuttersThatDoNotFitAreSeenSoon) {
  Atlas atlas;
  const Shape triangles = soup(150, 1);
  ASSERT_TRUE(atlas.add_instances(view_of(triangles), 40).ok());
  Context context;
  double farthest = 0;
  context.progress = [&](std::string_view stage, double fraction) {
    if (stage == "packing") farthest = std::max(farthest, fraction);
  };
  UnwrapOptions options{{.page_size = 256}};
  EXPECT_EQ(atlas.unwrap(options, context).status().code(), ErrorCode::no_solution);
  EXPECT_GT(farthest, 0);
  EXPECT_LT(farthest, 0.5);
}

}  // namespace
}  // namespace atlas::test
