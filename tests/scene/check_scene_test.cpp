// Scenes that programs build by themselves: the check names every array that does not fit the
// others, so that nothing is read past an end.
#include "libatlas/scene/check_scene.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace atlas {
namespace {

Scene square() {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  scene.indices = {0, 1, 2, 0, 2, 3};
  return scene;
}

void add_texture(Scene& scene) {
  scene.textures.resize(1);
  scene.textures[0].image = Image8(2, 2, 3, 9);
  scene.materials[0].texture = 0;
  scene.texcoords = {{0, 0}, {1, 1}};
  scene.texcoord_indices = {0, 1, 1, 0, 1, Scene::kNoTexcoord};
  scene.normals = {{0, 0, 1}};
  scene.normal_indices = {0, 0, 0, Scene::kNoNormal, Scene::kNoNormal, Scene::kNoNormal};
}

// Returns a lightmap of the square's two triangles, of which only the first lies on it.
SceneLightmap lightmap() {
  SceneLightmap map;
  map.pages = {ImageF(2, 2, 3, 9), ImageF()};
  map.texcoords = {{0, 0}, {1, 1}};
  map.texcoord_indices = {0, 1, 1, Scene::kNoTexcoord, Scene::kNoTexcoord, Scene::kNoTexcoord};
  map.triangle_page = {0, 1};
  return map;
}

void spoil_lightmap(Scene& scene, const std::function<void(SceneLightmap&)>& spoil) {
  SceneLightmap map = lightmap();
  spoil(map);
  scene.lightmap = std::make_shared<const SceneLightmap>(std::move(map));
}

TEST(CheckScene, CompletesPositionsAndIndices) {
  Scene scene = square();
  EXPECT_FALSE(check_scene(scene).ok());  // triangles have no material
  ASSERT_TRUE(complete_scene(scene).ok());
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.triangle_material, std::vector<std::uint32_t>(2, 0));
  EXPECT_EQ(scene.triangle_object, std::vector<std::uint32_t>(2, 0));
  add_texture(scene);
  spoil_lightmap(scene, [](SceneLightmap&) {});
  EXPECT_TRUE(check_scene(scene).ok()) << check_scene(scene).message();
}

TEST(CheckScene, KeepsWhatIsGiven) {
  Scene scene = square();
  scene.materials.resize(3);
  scene.triangle_material = {2, 1};
  ASSERT_TRUE(complete_scene(scene).ok());
  EXPECT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.triangle_material[0], 2u);
}

// Encoded images are sound, but cannot be baked.
TEST(CheckScene, ImagesToBakeMustBeDecoded) {
  Scene scene = square();
  ASSERT_TRUE(complete_scene(scene).ok());
  add_texture(scene);
  EXPECT_TRUE(check_images(scene).ok());
  scene.textures.push_back({{}, {}, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}});
  EXPECT_EQ(check_scene(scene).message(), "");
  EXPECT_EQ(check_images(scene).code(), ErrorCode::bad_input);
  EXPECT_NE(check_images(scene).message().find("textures[1] has no image"), std::string::npos);
}

TEST(CheckScene, NamesArrayAndElement) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const struct {
    const char* named;
    std::function<void(Scene&)> spoil;
  } cases[] = {
      {"4 indices", [](Scene& s) { s.indices.resize(4); }},
      {"indices[5] is 9, but there are 4 positions", [](Scene& s) { s.indices[5] = 9; }},
      {"positions[2]", [=](Scene& s) { s.positions[2].z = nan; }},
      {"illumination has 3 values for 4", [](Scene& s) { s.illumination.resize(3); }},
      {"illumination[1]",
       [=](Scene& s) {
         s.illumination.resize(4);
         s.illumination[1].y = nan;
       }},
      {"unlit_colours has 3 values for 4", [](Scene& s) { s.unlit_colours.resize(3); }},
      {"unlit_colours[3]",
       [=](Scene& s) {
         s.unlit_colours.resize(4);
         s.unlit_colours[3].z = nan;
       }},
      {"vertex_opacity has 3 values for 4", [](Scene& s) { s.vertex_opacity.resize(3); }},
      {"vertex_opacity[2] is nan",
       [=](Scene& s) {
         s.vertex_opacity = {1, 0, nan, 1};
       }},
      {"vertex_opacity[3] is 1.5",
       [](Scene& s) {
         s.vertex_opacity = {1, 0, 1, 1.5f};
       }},
      {"origin", [=](Scene& s) { s.origin.x = nan; }},
      {"metres_per_unit is inf",
       [](Scene& s) { s.metres_per_unit = std::numeric_limits<double>::infinity(); }},
      {"metres_per_unit is 0", [](Scene& s) { s.metres_per_unit = 0; }},
      {"triangle_material has 1 entries", [](Scene& s) { s.triangle_material.resize(1); }},
      {"triangle_material[1] is 4", [](Scene& s) { s.triangle_material[1] = 4; }},
      {"triangle_object has 5 entries", [](Scene& s) { s.triangle_object.resize(5); }},
      {"triangle_object[0] is 1", [](Scene& s) { s.triangle_object[0] = 1; }},
      {"materials[0] names texture 1", [](Scene& s) { s.materials[0].texture = 1; }},
      {"materials[0] names texture -2", [](Scene& s) { s.materials[0].texture = -2; }},
      {"the diffuse of materials[0]", [=](Scene& s) { s.materials[0].diffuse.y = nan; }},
      {"the emission of materials[0]", [=](Scene& s) { s.materials[0].emission.x = nan; }},
      {"the emission of materials[0]", [](Scene& s) { s.materials[0].emission.z = -1; }},
      {"the opacity of materials[0] is -0.5", [](Scene& s) { s.materials[0].opacity = -0.5f; }},
      {"the alpha_cutoff of materials[0] is -1",
       [](Scene& s) { s.materials[0].alpha_cutoff = -1; }},
      {"the alpha_cutoff of materials[0] is inf",
       [](Scene& s) { s.materials[0].alpha_cutoff = std::numeric_limits<float>::infinity(); }},
      {"texcoord_indices has 3 entries", [](Scene& s) { s.texcoord_indices.resize(3); }},
      {"texcoord_indices[2] is 7", [](Scene& s) { s.texcoord_indices[2] = 7; }},
      {"texcoords[1]", [=](Scene& s) { s.texcoords[1].x = nan; }},
      {"the image of textures[0] is 2 x 2 with 3 channels, but holds 5 values",
       [](Scene& s) { s.textures[0].image.texels.resize(5); }},
      {"normal_indices has 5 entries", [](Scene& s) { s.normal_indices.resize(5); }},
      {"normal_indices[1] is 1, but there are 1 normals",
       [](Scene& s) { s.normal_indices[1] = 1; }},
      {"normals[0] has length 2", [](Scene& s) { s.normals[0].z = 2; }},
      {"normals[0] has length 1.02", [](Scene& s) { s.normals[0].z = 1.02f; }},
      {"normals[0] has length nan", [=](Scene& s) { s.normals[0].z = nan; }},
      {"the opacity of materials[0] is 1.5", [](Scene& s) { s.materials[0].opacity = 1.5f; }},
      {"the alpha_cutoff of materials[0]", [=](Scene& s) { s.materials[0].alpha_cutoff = nan; }},
      {"textures[0] has both", [](Scene& s) { s.textures[0].encoded = {1}; }},
      {"the encoded of textures[0] is neither a PNG",
       [](Scene& s) {
         s.textures[0] = {{}, {}, {0xff, 0xd8}};
       }},
      {"lightmap has 5 texcoord_indices and 2 pages for 2 triangles",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.texcoord_indices.resize(5); }); }},
      {"lightmap.white is -1 (must be finite, 0 or more)",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.white = -1; }); }},
      {"lightmap.white is inf",
       [](Scene& s) {
         spoil_lightmap(s,
                        [](SceneLightmap& m) { m.white = std::numeric_limits<float>::infinity(); });
       }},
      {"lightmap has 6 texcoord_indices and 0 pages",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.triangle_page.clear(); }); }},
      {"lightmap.texcoords[1] is not finite",
       [=](Scene& s) { spoil_lightmap(s, [=](SceneLightmap& m) { m.texcoords[1].x = nan; }); }},
      {"lightmap.texcoord_indices[1] is 2",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.texcoord_indices[1] = 2; }); }},
      {"only some corners of triangle 1",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.texcoord_indices[4] = 0; }); }},
      {"lightmap.triangle_page[0] is 2",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.triangle_page[0] = 2; }); }},
      {"lightmap.triangle_page[0] is 1, which has no image",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.triangle_page[0] = 1; }); }},
      {"lightmap.pages[1] is 2 x 2 with 4 channels",
       [](Scene& s) {
         spoil_lightmap(s, [](SceneLightmap& m) { m.pages[1] = ImageF(2, 2, 4, 1); });
       }},
      {"lightmap.pages[0] is 2 x 2 with 3 channels (must be 3), and holds 7",
       [](Scene& s) { spoil_lightmap(s, [](SceneLightmap& m) { m.pages[0].texels.resize(7); }); }},
      {"lightmap.pages[0] has a value that is not finite",
       [=](Scene& s) { spoil_lightmap(s, [=](SceneLightmap& m) { m.pages[0].texels[3] = nan; }); }},
      {"the image of textures[0] is 0 x 0", [](Scene& s) { s.textures[0].image = {}; }},
  };
  for (const auto& c : cases) {
    Scene scene = square();
    ASSERT_TRUE(complete_scene(scene).ok());
    add_texture(scene);
    c.spoil(scene);
    const Status status = check_scene(scene);
    EXPECT_EQ(status.code(), ErrorCode::bad_input) << c.named;
    EXPECT_NE(status.message().find(c.named), std::string::npos)
        << c.named << ": " << status.message();
  }
}

}  // namespace
}  // namespace atlas
