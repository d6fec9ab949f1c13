// Tests what readers of glTF need, but the library's own reader does not check: the layout of the
// data, and the camera.
#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "libatlas/core/glm_bridge.h"
#include "tests/exporters/gltf_layout.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/exporters/worlds.h"
#include "tests/support/kept_scene.h"

namespace atlas::test {
namespace {

json document_of(const World& world, const std::filesystem::path& path) {
  const auto written = write_kept(world, path);
  EXPECT_TRUE(written.ok()) << written.status().message();
  return json::parse(gltf_json(path));
}

// Titles of any length, so that chunks end at any place.
TEST(GltfLayout, OfPagesAndScenes) {
  for (const char* name : {"w.glb", "w.gltf", "a w.gltf"}) {
    for (std::size_t length = 0; length < 4; ++length) {
      const TempFolder folder;
      World pages = wavy_world(7, 2);
      pages.title = std::string(length, 'x');
      for (Vec3f& p : pages.positions) p = {p.x - 100, -1 - p.y, 0.25f};  // all of y is negative
      for (Page& page : pages.pages) {
        page.image = "a " + page.image;
        page.image_source = folder.write(page.image, png_bytes(folder, 60));
      }
      ASSERT_TRUE(write_kept(pages, folder / name).ok());
      expect_gltf_layout(folder / name);
      const Scene scene = small_scene();
      World kept = world_of(scene);
      kept.title = pages.title;
      ASSERT_TRUE(write_kept(kept, folder / name).ok());
      expect_gltf_layout(folder / name);
    }
  }
}

// 65535 vertices have indices of 16 bits, more have not: the largest number means no vertex.
TEST(GltfLayout, OfFewAndManyVertices) {
  for (const std::size_t vertices : {65535, 65538}) {
    const TempFolder folder;
    Gltf gltf;
    std::vector<float> row;
    for (std::size_t i = 0; i < vertices; ++i)
      row.insert(row.end(), {float(i / 3), float(i % 3 == 1), float(i % 3 == 2)});
    gltf.single({{"attributes", {{"POSITION", gltf.floats(row, "VEC3", 3)}}}});
    ASSERT_EQ(keep(folder.write("s.glb", gltf.glb()), folder / "w.glb").vertices, vertices);
    expect_gltf_layout(folder / "w.glb");
  }
}

// A file that is kept may have positions of any sign, and morph targets that are not numbers, for
// which JSON has no bounds.
TEST(GltfLayout, OfKeptFiles) {
  const TempFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Gltf gltf;
  const int positions =
      gltf.floats({-1.5f, -3, -7, -0.25f, -3, -9.125f, -1.5f, -2.75f, -7}, "VEC3", 3);
  const int moves = gltf.floats({nan, 2, nan, 0.5f, 1, nan, 0, 3, nan}, "VEC3", 3);
  gltf.single({{"attributes", {{"POSITION", positions}}},
               {"targets", json::array({{{"POSITION", moves}}})}});
  ASSERT_EQ(keep(folder.write("s.glb", gltf.glb()), folder / "w.glb").triangles, 1u);
  expect_gltf_layout(folder / "w.glb");
  const json document = GltfOracle(folder / "w.glb").document;
  const json& target = document["meshes"][0]["primitives"][0]["targets"][0]["POSITION"];
  const json& accessor = document["accessors"][target.get<std::size_t>()];
  EXPECT_EQ(accessor["min"], (json{0, 1, 0}));
  EXPECT_EQ(accessor["max"], (json{0.5, 3, 0}));
}

TEST(GltfLayout, TextThatIsNoUtf8IsReplaced) {
  const TempFolder folder;
  World world = wavy_world(4, 1);
  world.pages[0].image.clear();
  world.title = "caf\xe9";
  const json extras = document_of(world, folder / "w.gltf")["asset"]["extras"];
  EXPECT_EQ(extras["title"], "caf\xef\xbf\xbd");
  EXPECT_EQ(extras["info"], (json{world.info[0], world.info[1]}));
}

// Follows the nodes as a viewer does. The root turns, scales and moves the scene, and the camera
// must stand and look in it where the viewpoint does.
TEST(GltfCamera, StandsAndLooksLikeTheViewpoint) {
  const TempFolder folder;
  for (const Up up : {Up::y, Up::z}) {
    World world = wavy_world(4, 1);
    world.pages[0].image.clear();
    world.up = up;
    world.metres_per_unit = 0.25;
    world.origin = {100, -20, 3};
    world.viewpoint.position = {1, 2, 3};
    world.viewpoint.direction = {2, 1, 0.5};
    world.viewpoint.fov = 0.75;
    const json file = document_of(world, folder / "w.gltf");
    EXPECT_EQ(file["cameras"][0]["perspective"]["yfov"], 0.75);
    const auto vector = [](const json& v) { return glm::dvec3(v[0], v[1], v[2]); };
    const auto turn = [](const json& node, const glm::dvec3& v) {
      if (!node.contains("rotation")) return v;
      const json& r = node["rotation"];
      return glm::mat3_cast(glm::dquat(r[3], r[0], r[1], r[2])) * v;
    };
    const json &root = file["nodes"][0], &camera = file["nodes"][1];
    const glm::dvec3 eye = vector(root["translation"]) +
                           turn(root, vector(root["scale"]) * to_glm(world.viewpoint.position));
    EXPECT_LT(glm::distance(vector(camera["translation"]), eye), 1e-9);
    const glm::dvec3 ahead = turn(root, glm::normalize(to_glm(world.viewpoint.direction)));
    EXPECT_LT(glm::distance(turn(camera, {0, 0, -1}), ahead), 1e-9);
    EXPECT_NEAR(turn(camera, {1, 0, 0}).y, 0, 1e-9) << "the view is tilted";
    EXPECT_GT(turn(camera, {0, 1, 0}).y, 0) << "upside down";
    // The root itself: glTF's vertical is y, and a position of the world lies at that many metres.
    const glm::dvec3 up_axis = up == Up::z ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    EXPECT_LT(glm::distance(turn(root, up_axis), glm::dvec3(0, 1, 0)), 1e-9);
    const glm::dvec3 origin = 0.25 * turn(root, to_glm(world.origin));
    EXPECT_LT(glm::distance(vector(root["translation"]), origin), 1e-9);
  }
}

// The format has no mesh without triangles, so later pages have other numbers than their meshes.
TEST(GltfPages, WithoutTrianglesAreLeftOut) {
  const TempFolder folder;
  World world = wavy_world(6, 2);
  world.pages.insert(world.pages.begin(), Page{"empty.png", {}, {}, {}});
  const json file = document_of(world, folder / "w.gltf");
  ASSERT_EQ(file["meshes"].size(), 2u);
  for (std::size_t m = 0; m < 2; ++m) {
    const json& primitive = file["meshes"][m]["primitives"][0];
    const json& material = file["materials"].at(primitive["material"].get<std::size_t>());
    const json& surface = material["pbrMetallicRoughness"];
    const json& texture =
        file["textures"].at(surface["baseColorTexture"]["index"].get<std::size_t>());
    EXPECT_EQ(file["images"].at(texture["source"].get<std::size_t>())["uri"],
              world.pages[m + 1].image);
    EXPECT_EQ(material["doubleSided"], true);
    EXPECT_EQ(surface["metallicFactor"], 0) << "the default is metal";
  }
}

}  // namespace
}  // namespace atlas::test
