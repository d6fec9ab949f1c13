// Tests World::scene: what a scene has besides its new uvs, read back by independent readers.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_worlds.h"
#include "tests/support/kept_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::KeptTriangle;
using test::small_scene;
using test::TempFolder;
using test::world_of;

Status write(const World& world, const std::filesystem::path& path) {
  return test::write_kept(world, path).status();
}

nlohmann::json gltf_of(const std::filesystem::path& path) {
  return nlohmann::json::parse(test::gltf_json(path));
}

TEST(KeptScene, HasALightmapThatIsConsistent) {
  const Scene scene = small_scene();
  const auto message = [&](const Lightmap& map) {
    World world = world_of(scene);
    world.lightmap = map;
    return check_world(world).message();
  };
  EXPECT_EQ(message({{"a.png"}, {}, 1}), "");
  EXPECT_EQ(message({{"a.png", "b.png"}, {"a.exr", "b.exr"}, 1, {0, 1, 1, 0}}), "");
  for (const auto& [map, part] :
       {std::pair{Lightmap{}, "0 images and 0 of linear"},
        {Lightmap{{"a.png", "b.png"}, {"a.exr"}}, "2 images and 1 of linear"},
        {Lightmap{{"a.png"}, {}, 1, {0, 0, 0}}, "the pages of 3 triangles, the scene has 4"},
        {Lightmap{{"a.png"}, {}, 1, {0, 0, 1, 0}},
         "triangle 2 is on page 1 of its lightmap, which has 1"}})
    EXPECT_NE(message(map).find(part), std::string::npos) << message(map);
}

// A primitive of each page; a writer of OBJ has no place for them.
TEST(KeptScene, NamesThePagesOfALightmap) {
  const TempFolder folder;
  const Scene scene = small_scene();
  World world = world_of(scene);
  world.lightmap = Lightmap{{"a.png", "b.png"}, {}, 1, {1, 0, 1, 1}};
  ASSERT_TRUE(write(world, folder / "w.gltf").ok());
  const auto triangles = test::read_kept_gltf(folder / "w.gltf");
  ASSERT_EQ(triangles.size(), 4u);
  std::vector<Vec3f> on_first;
  for (const KeptTriangle& t : triangles)
    if (t.page == 0) on_first.push_back(t.corners[0].position);
  EXPECT_EQ(on_first, std::vector<Vec3f>{scene.positions[scene.indices[3]]});
  const Status refused = write(world, folder / "w.obj");
  EXPECT_EQ(refused.code(), ErrorCode::bad_input);
  EXPECT_NE(refused.message().find("on which page of a lightmap"), std::string::npos);
}

TEST(KeptScene, OfGltfHasBothUvsNormalsNamesAndMaterials) {
  for (const char* name : {"w.gltf", "w.glb"}) {
    const TempFolder folder;
    const Scene scene = small_scene();
    const World world = world_of(scene);
    ASSERT_TRUE(write(world, folder / name).ok());
    const auto triangles = test::read_kept_gltf(folder / name);
    ASSERT_EQ(triangles.size(), 4u);
    for (std::size_t t = 0; t < 4; ++t) {
      EXPECT_EQ(triangles[t].object, scene.object_names[scene.triangle_object[t]]);
      EXPECT_EQ(triangles[t].material, scene.materials[scene.triangle_material[t]].name);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto& corner = triangles[t].corners[c];
        const std::size_t k = 3 * t + c;
        EXPECT_EQ(corner.position, scene.positions[scene.indices[k]]);
        EXPECT_EQ(corner.texcoord, scene.texcoords[scene.texcoord_indices[k]]);
        EXPECT_EQ(corner.normal, scene.normals[scene.normal_indices[k]]);
        EXPECT_EQ(corner.uv, world.uvs[k]);
      }
    }
    const auto gltf = gltf_of(folder / name);
    // There is nothing to rotate, scale or move, and no camera.
    EXPECT_EQ(gltf["nodes"].size(), 2u);
    EXPECT_FALSE(gltf.contains("cameras") || gltf.contains("extensionsUsed"));
    EXPECT_EQ(gltf["materials"].size(), 2u);
    EXPECT_EQ(gltf["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"],
              (nlohmann::json{0.5, 0.25, 1.0, 1}));
  }
}

// Engines expect lightmap uvs in TEXCOORD_1, whatever else there is.
TEST(KeptScene, OfGltfWithoutUvsOfItsOwnHasTheNewOnesTwice) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.texcoord_indices[4] = Scene::kNoTexcoord;  // if one corner has none, its triangle has none
  scene.normal_indices[0] = Scene::kNoNormal;
  scene.texcoord_indices[6] = scene.texcoord_indices[9] = Scene::kNoTexcoord;
  const World world = world_of(scene);
  ASSERT_TRUE(write(world, folder / "w.glb").ok());
  const auto triangles = test::read_kept_gltf(folder / "w.glb");
  const bool texcoords[4] = {true, false, false, false}, normals[4] = {false, true, true, true};
  for (std::size_t t = 0; t < 4; ++t) {
    EXPECT_EQ(triangles[t].has_texcoords, texcoords[t]) << t;
    EXPECT_EQ(triangles[t].has_normals, normals[t]) << t;
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(triangles[t].corners[c].uv, world.uvs[3 * t + c]);
  }
  scene = small_scene();
  scene.texcoords.clear();
  scene.texcoord_indices.clear();
  scene.normal_indices.clear();
  ASSERT_TRUE(write(world_of(scene), folder / "v.glb").ok());
  for (const KeptTriangle& t : test::read_kept_gltf(folder / "v.glb"))
    EXPECT_FALSE(t.has_texcoords || t.has_normals);
}

// Vertices are split where necessary, and not where a file repeats a value.
TEST(KeptScene, OfGltfSharesVerticesOfEqualAttributes) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.triangle_material = {0, 0, 0, 0};
  std::vector<Vec2f> texcoords;
  std::vector<Vec3f> normals;
  for (std::uint32_t k = 0; k < 12; ++k) {
    texcoords.push_back(scene.texcoords[scene.texcoord_indices[k]]);
    normals.push_back(scene.normals[scene.normal_indices[k]]);
    scene.texcoord_indices[k] = scene.normal_indices[k] = k;
  }
  scene.texcoords = texcoords;
  scene.normals = normals;
  World world = world_of(scene);
  world.pages[0].uv_indices = scene.indices;
  AtomicFiles files;
  const auto written = write_gltf(world, folder / "w.glb", files, {});
  ASSERT_TRUE(written.ok());
  EXPECT_EQ(written->vertices, 8u);
  EXPECT_EQ(written->triangles, 4u);
}

std::string bytes_of(const Texture& texture) {
  return {texture.encoded.begin(), texture.encoded.end()};
}

void add_textures(Scene& scene, const TempFolder& folder) {
  Image8 image(3, 2, 3, 40);
  image.at(0, 0)[0] = 200;  // bottom left
  EXPECT_TRUE(write_png(folder / "made.png", image, {}).ok());
  const std::string png = TempFolder::read(folder / "made.png");
  std::filesystem::remove(folder / "made.png");
  scene.textures.resize(2);
  scene.textures[0].encoded.assign(png.begin(), png.end());
  scene.textures[1].image = Image8(2, 2, 5, 9);  // PNG does not have that many channels
  scene.textures[1].image.at(1, 1)[2] = 250;
  scene.materials[0].texture = 1;
  scene.materials[1].texture = 0;
}

TEST(KeptScene, TexturesGoWithAGltf) {
  for (const char* name : {"my world.gltf", "w.glb"}) {
    const TempFolder folder;
    Scene scene = small_scene();
    add_textures(scene, folder);
    ASSERT_TRUE(write(world_of(scene), folder / name).ok());
    EXPECT_EQ(folder.count(), name[0] == 'm' ? 4u : 1u);
    const auto loaded = read_scene(folder / name, {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_TRUE(loaded->defects.empty());
    const Scene& back = loaded->scene;
    ASSERT_EQ(back.textures.size(), 2u);
    EXPECT_EQ(back.textures[back.materials[0].texture].image.at(1, 1)[2], 250);
    EXPECT_EQ(back.textures[back.materials[1].texture].image.at(0, 0)[0], 200);
    const auto raw = read_scene(folder / name, {.encoded_textures = true}, {});
    EXPECT_EQ(bytes_of(raw->scene.textures[1]), bytes_of(scene.textures[0]));
    if (name[0] != 'm') continue;
    EXPECT_EQ(TempFolder::read(scene_texture_paths(scene, folder / name)[0]),
              bytes_of(scene.textures[0]));
  }
}

// Where uvs are missing, a reader uses the plain colour; a viewer would use the colour of one
// texel.
TEST(KeptScene, TexturesNeedUvs) {
  const TempFolder folder;
  Scene scene = small_scene();
  add_textures(scene, folder);
  for (std::size_t k = 6; k < 12; ++k) scene.texcoord_indices[k] = Scene::kNoTexcoord;
  ASSERT_TRUE(write(world_of(scene), folder / "w.glb").ok());
  const auto triangles = test::read_kept_gltf(folder / "w.glb");
  EXPECT_FALSE(triangles[0].image.empty());
  EXPECT_TRUE(triangles[2].image.empty());
  EXPECT_EQ(triangles[2].material, "paint");
}

TEST(KeptScene, MaterialsStayAsTransparentAsTheyWere) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].opacity = 0.5f;
  scene.materials[0].double_sided = false;
  scene.materials[1].alpha_mode = AlphaMode::mask;
  scene.materials[1].alpha_cutoff = 0.75f;
  ASSERT_TRUE(write(world_of(scene), folder / "w.glb").ok());
  const auto gltf = gltf_of(folder / "w.glb");
  EXPECT_EQ(gltf["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3], 0.5);
  EXPECT_EQ(gltf["materials"][0]["alphaMode"], "BLEND");
  EXPECT_FALSE(gltf["materials"][0].contains("doubleSided"));
  EXPECT_EQ(gltf["materials"][1]["alphaMode"], "MASK");
  EXPECT_EQ(gltf["materials"][1]["alphaCutoff"], 0.75);
  EXPECT_EQ(gltf["materials"][1]["doubleSided"], true);
  ASSERT_TRUE(write(world_of(scene), folder / "w.obj").ok());
  EXPECT_NE(TempFolder::read(folder / "w.mtl").find("\nd 0.5\n"), std::string::npos);
}

// Colours stay colours. Values that cannot be colours get a name that only readers of light know.
TEST(KeptScene, WhatVerticesCarryStays) {
  const TempFolder folder;
  for (const float largest : {1.f, 70000.f}) {
    Scene scene = small_scene();
    scene.illumination = {{0, 0.25f, 1}, {0.5f, 0.5f, 0}, {largest, 0, 0}, {0.125f, 1, 1}};
    for (const char* name : {"w.glb", "w.obj"}) {
      ASSERT_TRUE(write(world_of(scene), folder / name).ok());
      const auto loaded = read_scene(folder / name, {}, {});
      ASSERT_TRUE(loaded.ok()) << loaded.status().message();
      const Scene& back = loaded->scene;
      ASSERT_TRUE(back.lit());
      for (const std::uint32_t i : back.indices) {
        const auto same =
            std::find(scene.positions.begin(), scene.positions.end(), back.positions[i]);
        EXPECT_EQ(back.illumination[i],
                  scene.illumination[std::size_t(same - scene.positions.begin())]);
      }
    }
    const auto attributes = gltf_of(folder / "w.glb")["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_EQ(attributes.contains("COLOR_0"), largest == 1);
    EXPECT_EQ(attributes.contains("_ILLUMINANCE"), largest != 1);
  }
}

// Readers use 0 if one mesh of a file has colours and another has none.
TEST(KeptScene, PartsWithoutLightAreNotBlack) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.positions.insert(scene.positions.end(), {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}});
  scene.indices = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 5};
  scene.illumination = {{0.5f, 1, 1}, {}, {}, {1, 1, 1}, {}, {}, {}};
  ASSERT_TRUE(write(world_of(scene), folder / "w.glb").ok());
  const auto gltf = gltf_of(folder / "w.glb");
  EXPECT_TRUE(gltf["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
  EXPECT_FALSE(gltf["meshes"][1]["primitives"][0]["attributes"].contains("COLOR_0"));
}

TEST(KeptScene, IsTurnedScaledAndMovedByARoot) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.origin = {1024, 512, 2048};
  World world = world_of(scene);
  world.up = Up::z;
  world.metres_per_unit = 0.5;
  ASSERT_TRUE(write(world, folder / "w.glb").ok());
  const auto loaded = read_scene(folder / "w.glb", {.normals = true}, {});
  ASSERT_TRUE(loaded.ok());
  const Scene& back = loaded->scene;
  EXPECT_EQ(back.object_names, scene.object_names);
  const Vec3f p = back.positions[back.indices[2]];
  EXPECT_NEAR(back.origin.x + p.x, 0.5 * 1025, 1e-4);
  EXPECT_NEAR(back.origin.y + p.y, 0.5 * 2048, 1e-4);
  EXPECT_NEAR(back.origin.z + p.z, -0.5 * 513, 1e-4);
  EXPECT_NEAR(back.normals[back.normal_indices[0]].y, 1, 1e-6);
}

TEST(KeptScene, OfObjHasNewUvsNormalsNamesAndColours) {
  const TempFolder folder;
  const Scene scene = small_scene();
  const World world = world_of(scene);
  ASSERT_TRUE(write(world, folder / "w.obj").ok());
  const auto triangles = test::read_kept_obj(folder / "w.obj");
  ASSERT_EQ(triangles.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t) {
    EXPECT_EQ(triangles[t].object, scene.object_names[scene.triangle_object[t]]);
    // A '#' after a blank would begin a comment.
    EXPECT_EQ(triangles[t].material, t == 1 ? "wood _ 2" : "paint");
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& corner = triangles[t].corners[c];
      EXPECT_EQ(corner.position, scene.positions[scene.indices[3 * t + c]]);
      EXPECT_EQ(corner.texcoord, world.uvs[3 * t + c]);
      EXPECT_EQ(corner.normal, scene.normals[scene.normal_indices[3 * t + c]]);
    }
  }
  const std::string obj = TempFolder::read(folder / "w.obj"), front = "\no front\n";
  ASSERT_NE(obj.find(front), std::string::npos);
  EXPECT_EQ(obj.find(front), obj.rfind(front)) << "an object of two materials is one object";
  const std::string mtl = TempFolder::read(folder / "w.mtl");
  EXPECT_NE(mtl.find("newmtl paint\nKd 0.5 0.25 1\n"), std::string::npos) << mtl;
  EXPECT_EQ(mtl.find("\nmap_Kd"), std::string::npos);
}

// MTL distinguishes materials only by their names.
TEST(KeptScene, OfObjHasMaterialsOfDifferentNames) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.materials.resize(5);
  for (const std::size_t m : {0, 2}) scene.materials[m].name = "a";
  scene.materials[1].name = "a_2";
  scene.materials[3].name = "  \nline\\";
  for (std::size_t m = 0; m < 5; ++m) scene.materials[m].diffuse = {float(m) / 8, 0, 0};
  scene.triangle_material = {0, 1, 2, 4};
  scene.object_names = {"", ""};
  ASSERT_TRUE(write(world_of(scene), folder / "w.obj").ok());
  const auto loaded = read_scene(folder / "w.obj", {}, {});
  ASSERT_TRUE(loaded.ok());
  EXPECT_TRUE(loaded->defects.empty());
  const Scene& back = loaded->scene;
  ASSERT_EQ(back.materials.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t)
    EXPECT_EQ(back.materials[back.triangle_material[t]].diffuse,
              scene.materials[scene.triangle_material[t]].diffuse);
  EXPECT_EQ(back.object_names, (std::vector<std::string>{"", "object1"}));
}

TEST(KeptScene, OfObjMayLackNormalsInPlaces) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.normal_indices[3] = Scene::kNoNormal;
  ASSERT_TRUE(write(world_of(scene), folder / "w.obj").ok());
  const auto triangles = test::read_kept_obj(folder / "w.obj");
  ASSERT_EQ(triangles.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(triangles[t].has_normals, t != 1);
}

TEST(KeptScene, WhatDoesNotAgreeIsRefusedAndNothingWritten) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const struct {
    const char* named;
    std::function<void(World&, Scene&)> spoil;
  } cases[] = {
      {"one page", [](World& w, Scene&) { w.pages.push_back({}); }},
      {"without an image", [](World& w, Scene&) { w.pages[0].image = "a.png"; }},
      {"other corners",
       [](World& w, Scene&) { std::swap(w.pages[0].indices[1], w.pages[0].indices[2]); }},
      {"other corners", [](World&, Scene& s) { s.positions.push_back({}); }},
      {"normals[1]", [=](World&, Scene& s) { s.normals[1].x = nan; }},
      {"normal_indices[3] is 7", [](World&, Scene& s) { s.normal_indices[3] = 7; }},
      {"neither a PNG nor a JPEG",
       [](World&, Scene& s) {
         s.textures.resize(1), s.textures[0].encoded = {1, 2, 3};
       }},
      {"no triangle",
       [](World& w, Scene& s) {
         s = {}, w = {};
         w.pages.resize(1), w.scene = &s;
       }},
  };
  for (const auto& c : cases) {
    for (const char* name : {"w.gltf", "w.glb", "w.obj"}) {
      const TempFolder folder;
      Scene scene = small_scene();
      World world = world_of(scene);
      c.spoil(world, scene);
      const Status status = write(world, folder / name);
      EXPECT_EQ(status.code(), ErrorCode::bad_input) << c.named;
      EXPECT_NE(status.message().find(c.named), std::string::npos) << status.message();
      EXPECT_EQ(folder.count(), 0u);
    }
  }
  const TempFolder folder;
  const Scene scene = small_scene();
  const Status vrml = write(world_of(scene), folder / "w.wrl");
  EXPECT_EQ(vrml.code(), ErrorCode::bad_option);
  EXPECT_NE(vrml.message().find("write .gltf, .glb or .obj"), std::string::npos);
  EXPECT_EQ(folder.count(), 0u);
  EXPECT_FALSE(holds_scene("w.wrz"));
  EXPECT_TRUE(embeds_images("W.GLB"));
  EXPECT_FALSE(embeds_images("w.gltf") || embeds_images("w.obj") || embeds_images("w.png"));
  EXPECT_EQ(file_beside("a/w.gltf"), "a/w.bin");
  EXPECT_EQ(file_beside("a/w.OBJ"), "a/w.mtl");
  EXPECT_EQ(file_beside("w.glb"), "");
  EXPECT_TRUE(holds_scene("W.GLB") && holds_scene("w.gltf") && holds_scene("w.obj"));
}

}  // namespace
}  // namespace atlas
