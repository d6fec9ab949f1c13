// Meshes of polygons, of instances, and of earlier headers, by the C interface.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "libatlas/c/atlas.h"
#include "libatlas/unwrap/atlas.h"
#include "tests/c/c_fixture.h"
#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

TEST_F(C, PolygonsComeBackAsFromTheAtlas) {
  // A box of six quads.
  const Shape cube = box(1);
  std::vector<std::uint32_t> corners, sizes(6, 4);
  for (std::size_t t = 0; t < cube.indices.size(); t += 6)
    corners.insert(corners.end(), {cube.indices[t], cube.indices[t + 1], cube.indices[t + 2],
                                   cube.indices[t + 5]});
  Atlas expected;
  ASSERT_TRUE(expected
                  .add(StridedMesh{.positions = {cube.positions.data(), cube.positions.size(), 0},
                                   .indices = {corners.data(), corners.size(), 4},
                                   .polygon_sizes = sizes})
                  .ok());
  const auto result = expected.unwrap({}, {});
  ASSERT_TRUE(result.ok());
  const auto atlas = atlas_of({});
  libatlas_mesh mesh = mesh_of(cube);
  mesh.indices = corners.data();
  mesh.index_count = corners.size();
  mesh.polygon_sizes = sizes.data();
  mesh.polygon_count = sizes.size();
  ASSERT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, nullptr), LIBATLAS_OK) << message();
  const auto unwrapped = unwrap(atlas.get());
  auto polygons = sized<libatlas_polygon_uvs>();
  ASSERT_EQ(libatlas_get_polygons(context(), unwrapped.get(), 0, &polygons), LIBATLAS_OK);
  EXPECT_EQ(polygons.polygon_count, 6u);
  EXPECT_EQ(polygons.cut_count, 0u);
  EXPECT_TRUE(same(polygons.corners, polygons.corner_count, result->mesh(0).polygon_corners));
  EXPECT_TRUE(same(polygons.triangle_polygon, 12, result->mesh(0).triangle_polygon));
  std::vector<std::uint8_t> seams(24);
  EXPECT_EQ(libatlas_get_seams(context(), atlas.get(), unwrapped.get(), 0, seams.data(), 24),
            LIBATLAS_OK)
      << message();
  EXPECT_EQ(seams, *expected.seams(*result, 0));

  // Of triangles there are none.
  const auto plain = unwrap(atlas_of({cube}).get());
  ASSERT_EQ(libatlas_get_polygons(context(), plain.get(), 0, &polygons), LIBATLAS_OK);
  EXPECT_EQ(polygons.polygon_count + polygons.corner_count, 0u);
  const auto refused = [&](const char* text) {
    EXPECT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, nullptr), LIBATLAS_BAD_INPUT);
    EXPECT_NE(message().find(text), std::string::npos) << message();
  };
  sizes[2] = 5;
  refused("mesh 1: 6 polygons have 25 corners in all, but there are 24 indices");
  sizes[2] = 1;
  refused("mesh 1: polygon 2: 1 corners");
  mesh.polygon_count = 0;
  refused("polygon_count is 0, but polygon_sizes is given");
}

TEST_F(C, InstancesComeBackAsFromTheAtlas) {
  const std::vector<float> densities{1, 2, 0.5f};
  Atlas expected;
  ASSERT_TRUE(expected.add_instances(view_of(shapes_[0]), 3, densities).ok());
  ASSERT_TRUE(expected.add(view_of(shapes_[1])).ok());
  const auto result = expected.unwrap({}, {});
  ASSERT_TRUE(result.ok());
  const auto atlas = atlas_of({});
  const libatlas_mesh mesh = mesh_of(shapes_[0]), once = mesh_of(shapes_[1]);
  std::uint32_t number = 9;
  ASSERT_EQ(libatlas_add_instances(context(), atlas.get(), &mesh, densities.data(), 3, &number),
            LIBATLAS_OK)
      << message();
  EXPECT_EQ(number, 0u);
  ASSERT_EQ(libatlas_add_mesh(context(), atlas.get(), &once, nullptr), LIBATLAS_OK);
  const auto unwrapped = unwrap(atlas.get());
  auto instances = sized<libatlas_instances>();
  ASSERT_EQ(libatlas_get_instances(context(), unwrapped.get(), 0, &instances), LIBATLAS_OK);
  ASSERT_EQ(instances.instance_count, 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const MeshInstance& own = result->mesh(0).instances[i];
    const libatlas_instance& at = instances.instances[i];
    EXPECT_EQ(at.page, own.page);
    EXPECT_EQ((Vec2f{at.scale[0], at.scale[1]}), own.scale);
    EXPECT_EQ((Vec2f{at.offset[0], at.offset[1]}), own.offset);
  }
  auto uvs = sized<libatlas_mesh_uvs>();
  ASSERT_EQ(libatlas_get_mesh(context(), unwrapped.get(), 0, &uvs), LIBATLAS_OK);
  EXPECT_EQ(std::memcmp(uvs.uvs, result->mesh(0).uvs.data(), result->mesh(0).uvs.size_bytes()), 0);
  ASSERT_EQ(libatlas_get_instances(context(), unwrapped.get(), 1, &instances), LIBATLAS_OK);
  EXPECT_EQ(instances.instance_count, 0u);

  const auto refused = [&](const float* d, std::size_t count, const char* text) {
    EXPECT_EQ(libatlas_add_instances(context(), atlas.get(), &mesh, d, count, nullptr),
              LIBATLAS_BAD_INPUT);
    EXPECT_NE(message().find(text), std::string::npos) << message();
  };
  refused(nullptr, 0, "mesh 2: no instance");
  const std::vector<float> broken{1, NAN, 0};
  refused(broken.data(), 3, "mesh 2: instance 1: density nan");
  refused(broken.data() + 2, 1, "mesh 2: instance 0: density 0");
  EXPECT_EQ(libatlas_add_instances(context(), atlas.get(), &mesh, nullptr,
                                   std::numeric_limits<std::size_t>::max(), nullptr),
            LIBATLAS_UNSUPPORTED);
  EXPECT_EQ(libatlas_add_instances(context(), nullptr, &mesh, nullptr, 1, nullptr),
            LIBATLAS_BAD_INPUT);
}

TEST_F(C, SeamsKeepAwayFromHighWeights) {
  const Shape tube = cylinder(40, 20);
  for (const float side : {-1.0f, 1.0f}) {
    const auto atlas = atlas_of({shapes_[0]});  // which has no weights
    std::vector<float> weights;
    for (const Vec3f p : tube.positions) weights.push_back(side * p.x > 0 ? 10 : 1);
    libatlas_mesh mesh = mesh_of(tube);
    mesh.seam_weights = weights.data();
    ASSERT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, nullptr), LIBATLAS_OK) << message();
    const auto unwrapped = unwrap(atlas.get());
    std::vector<std::uint8_t> seams(tube.indices.size());
    ASSERT_EQ(
        libatlas_get_seams(context(), atlas.get(), unwrapped.get(), 1, seams.data(), seams.size()),
        LIBATLAS_OK);
    EXPECT_NE(std::count(seams.begin(), seams.end(), 1), 0);
    for (std::size_t h = 0; h < seams.size(); ++h) {
      if (seams[h]) {
        EXPECT_LE(side * tube.positions[tube.indices[h]].x, 1e-6) << h;
      }
    }
    weights[3] = NAN;
    EXPECT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, nullptr), LIBATLAS_BAD_INPUT);
    EXPECT_NE(message().find("mesh 2: vertex 3: seam weight nan"), std::string::npos) << message();
  }
}

// As a program does that was compiled before meshes had polygons.
TEST_F(C, MeshesOfEarlierHeadersAreTaken) {
  libatlas_mesh mesh = mesh_of(shapes_[1]);
  mesh.size = offsetof(libatlas_mesh, polygon_sizes);
  mesh.polygon_sizes = reinterpret_cast<const std::uint32_t*>(1);  // beyond what it has
  const auto atlas = atlas_of({});
  ASSERT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, nullptr), LIBATLAS_OK) << message();
  EXPECT_TRUE(unwrap(atlas.get()));
  std::memset(static_cast<void*>(&mesh), 7, sizeof mesh);
  ASSERT_EQ(libatlas_mesh_init(&mesh, offsetof(libatlas_mesh, polygon_sizes)), LIBATLAS_OK);
  EXPECT_EQ(mesh.size, offsetof(libatlas_mesh, polygon_sizes));
  EXPECT_EQ(mesh.density, 1);
  EXPECT_NE(mesh.polygon_count, 0u);  // not touched
  mesh.size = offsetof(libatlas_mesh, polygon_sizes) - 1;
  EXPECT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, nullptr), LIBATLAS_BAD_OPTION);
}

}  // namespace
}  // namespace atlas::test
