// Tests World::scene: how materials and names of a scene without a source are written.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_worlds.h"
#include "tests/support/full_disk.h"
#include "tests/support/kept_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using nlohmann::json;
using Lines = std::vector<std::string>;

json gltf_of(const Scene& scene, const std::filesystem::path& path) {
  const auto written = write_kept(world_of(scene), path);
  EXPECT_TRUE(written.ok()) << written.status().message();
  return json::parse(gltf_json(path));
}

std::string mtl_of(const Scene& scene, const TempFolder& folder) {
  const auto written = write_kept(world_of(scene), folder / "w.obj");
  EXPECT_TRUE(written.ok()) << written.status().message();
  return TempFolder::read(folder / "w.mtl");
}

// One image may be used with several wrap modes, which are the sampler's.
TEST(KeptLook, EachPairOfWrapModesIsOneTexture) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.textures.resize(1);
  scene.textures[0].image = Image8(2, 2, 3, 9);
  scene.textures.push_back(scene.textures[0]);
  const std::pair<TextureWrap, TextureWrap> wraps[] = {
      {TextureWrap::clamp, TextureWrap::mirror},
      {TextureWrap::mirror, TextureWrap::mirror},
      {TextureWrap::clamp, TextureWrap::repeat},
      {TextureWrap::clamp, TextureWrap::mirror},   // the first again
      {TextureWrap::clamp, TextureWrap::mirror}};  // of the other image
  for (auto* list : {&scene.indices, &scene.texcoord_indices, &scene.normal_indices})
    list->insert(list->end(), list->begin(), list->begin() + 3);
  scene.triangle_object = {0, 0, 0, 0, 0};
  scene.triangle_material = {0, 1, 2, 3, 4};
  scene.materials.resize(5);
  for (std::size_t m = 0; m < 5; ++m) {
    scene.materials[m].texture = m == 4 ? 1 : 0;
    std::tie(scene.materials[m].wrap_u, scene.materials[m].wrap_v) = wraps[m];
  }
  const json file = gltf_of(scene, folder / "w.glb");
  EXPECT_EQ(file["images"].size(), 2u);
  EXPECT_EQ(file["textures"].size(), 4u);
  EXPECT_EQ(file["samplers"].size(), 3u);
  // OpenGL's numbers; repeating is the default of the format.
  const std::map<TextureWrap, int> numbers{
      {TextureWrap::clamp, 0x812f}, {TextureWrap::mirror, 0x8370}, {TextureWrap::repeat, 0x2901}};
  std::size_t t = 0;
  for (const json& mesh : file["meshes"]) {
    for (const json& primitive : mesh["primitives"]) {
      const json& surface =
          file["materials"][primitive["material"].get<std::size_t>()]["pbrMetallicRoughness"];
      const json& texture =
          file["textures"][surface["baseColorTexture"]["index"].get<std::size_t>()];
      const json& sampler = file["samplers"][texture["sampler"].get<std::size_t>()];
      EXPECT_EQ(sampler.value("wrapS", 0x2901), numbers.at(wraps[t].first)) << t;
      EXPECT_EQ(sampler.value("wrapT", 0x2901), numbers.at(wraps[t].second)) << t;
      EXPECT_EQ(sampler["magFilter"], 0x2601);
      EXPECT_EQ(sampler["minFilter"], 0x2703);
      EXPECT_EQ(texture["source"], t == 4 ? 1 : 0);
      ++t;
    }
  }
  EXPECT_EQ(t, 5u);
}

TEST(KeptLook, ImagesSayWhatTheyAre) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.textures.resize(2);
  scene.textures[0].encoded = {0xff, 0xd8, 0xff, 0xe0};  // how a JPEG begins
  scene.textures[1].image = Image8(2, 2, 4, 9);
  scene.textures[1].image.at(0, 0)[3] = 100;
  scene.materials[0].texture = 0;
  scene.materials[1].texture = 1;
  const json images = gltf_of(scene, folder / "w.glb")["images"];
  EXPECT_EQ(images[0]["mimeType"], "image/jpeg");
  EXPECT_EQ(images[1]["mimeType"], "image/png");
  gltf_of(scene, folder / "a w#.gltf");
  EXPECT_EQ(scene_texture_paths(scene, folder / "a w#.gltf")[0].extension(), ".jpg");
  const auto png = scene_texture_paths(scene, folder / "a w#.gltf")[1];
  EXPECT_EQ(png.filename().string().find_first_of(" #"), std::string::npos);
  const auto back = read_image8(png);
  ASSERT_TRUE(back.ok()) << back.status().message();
  ASSERT_EQ(back->channels, 4);  // the opacity stays
  EXPECT_EQ(back->at(0, 0)[3], 100);
}

TEST(KeptLook, WhatHasNoNameGetsNone) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.object_names = {"", "back"};
  scene.materials[0].name.clear();
  const json file = gltf_of(scene, folder / "w.glb");
  EXPECT_FALSE(file["materials"][0].contains("name"));
  EXPECT_FALSE(file["meshes"][0].contains("name"));
  EXPECT_FALSE(file["nodes"][0].contains("name"));
  EXPECT_EQ(file["nodes"][1]["name"], "back");
}

// Factors of glTF are at most 1, and light below 0 is no colour.
TEST(KeptLook, ValuesBeyondColours) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.materials[0].diffuse = {3, -1, 0.5f};
  scene.illumination = {{0, 0, 0}, {1, 1, 1}, {0, -0.5f, 0}, {1, 1, 1}};
  const json file = gltf_of(scene, folder / "w.glb");
  EXPECT_EQ(file["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"], (json{1, 0, 0.5, 1}));
  EXPECT_TRUE(file["meshes"][0]["primitives"][0]["attributes"].contains("_ILLUMINANCE"));
}

// Each of the three needs the node above.
TEST(KeptLook, AnAxisAUnitOrAnOriginNeedsARoot) {
  const TempFolder folder;
  for (const int what : {0, 1, 2, 3}) {
    Scene scene = small_scene();
    if (what == 3) scene.origin = {0, 0, 7};
    World world = world_of(scene);
    if (what == 1) world.up = Up::z;
    if (what == 2) world.metres_per_unit = 0.5;
    ASSERT_TRUE(write_kept(world, folder / "w.gltf").ok());
    const json file = json::parse(gltf_json(folder / "w.gltf"));
    EXPECT_EQ(file["nodes"].size(), what == 0 ? 2u : 3u);
    EXPECT_EQ(file["scenes"][0]["nodes"], what == 0 ? (json{0, 1}) : json{0});
    if (what == 0) continue;
    EXPECT_EQ(file["nodes"][0]["children"], (json{1, 2}));
  }
}

// A program may make lines of its own. A line break or a backslash in one must not begin another.
TEST(KeptLook, LinesOfMtlStayLines) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.materials[0].mtl_lines = {"Ns 1\nnewmtl wood", "Ni 2\\", "map_Ke a\rmap_Kd b.png"};
  const std::string mtl = mtl_of(scene, folder);
  EXPECT_NE(mtl.find("\nNs 1 newmtl wood\nNi 2 \n#map_Ke a map_Kd b.png\n"), std::string::npos)
      << mtl;
}

// The colour of an emission that a texture shapes would make the whole surface glow.
TEST(KeptLook, EmissionOfTexturesIsLeftOutOfMtl) {
  const TempFolder folder;
  Scene scene = small_scene();
  for (Material& material : scene.materials) material.emission = {1, 2, 3};
  scene.materials[0].emission_textured = true;
  const std::string mtl = mtl_of(scene, folder);
  EXPECT_EQ(mtl.find("Ke"), mtl.rfind("Ke")) << mtl;
  EXPECT_GT(mtl.find("Ke 1 2 3"), mtl.find("newmtl wood"));
}

TEST(KeptLook, LossesOfObjAreCounted) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.textures.resize(1);
  scene.textures[0].image = Image8(2, 2, 3, 9);
  scene.not_read = {{"widgets", 3}};
  scene.materials[0].texture = scene.materials[1].texture = 0;
  scene.materials[1].mtl_lines = {"map_Kd a.png"};  // counted as the line that it is
  const auto written = write_kept(world_of(scene), folder / "w.obj");
  ASSERT_TRUE(written.ok());
  EXPECT_EQ(written->not_kept, (Lines{"1 x textures of materials",
                                      "1 x textures of materials (lines of the MTL, now comments)",
                                      "4 x triangles with uvs of their own", "3 x widgets"}));
  for (const std::size_t corner : {3, 4, 5, 6}) scene.texcoord_indices[corner] = Scene::kNoTexcoord;
  EXPECT_EQ(write_kept(world_of(scene), folder / "w.obj")->not_kept[2],
            "3 x triangles with uvs of their own");
  EXPECT_EQ(write_kept(world_of(scene), folder / "w.glb")->not_kept, Lines{"3 x widgets"});
}

// In an OBJ, a '#' at the begin of a word begins a comment, and blanks around a name are lost.
TEST(KeptLook, NamesThatObjCanHold) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.materials = {{"#1"}, {" a "}, {"a"}, {"a_2"}};
  scene.triangle_material = {0, 1, 2, 3};
  scene.object_names = {"one\t#2 ", "\t two"};
  const std::string mtl = mtl_of(scene, folder), obj = TempFolder::read(folder / "w.obj");
  Lines names;
  for (std::size_t at = 0; (at = mtl.find("\nnewmtl ", at)) != std::string::npos; ++at)
    names.push_back(mtl.substr(at + 8, mtl.find('\n', at + 8) - at - 8));
  ASSERT_EQ(names.size(), 4u);
  EXPECT_EQ(names[0], "_1");
  EXPECT_EQ(names[1], "a");
  EXPECT_EQ(names[3], "a_2");  // not given to another one
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 4u);
  EXPECT_NE(obj.find("\no one\t_2\n"), std::string::npos) << obj;
  EXPECT_NE(obj.find("\no two\n"), std::string::npos) << obj;
}

// One corner without a normal is enough, whichever it is. Normals that the scene repeats are
// written once.
TEST(KeptLook, NormalsOfObj) {
  const TempFolder folder;
  for (const std::size_t corner : {3, 4, 5}) {
    Scene scene = small_scene();
    scene.normals = {{0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
    scene.normal_indices[0] = 2;
    scene.normal_indices[corner] = Scene::kNoNormal;
    mtl_of(scene, folder);
    const auto triangles = read_kept_obj(folder / "w.obj");
    ASSERT_EQ(triangles.size(), 4u);
    for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(triangles[t].has_normals, t != 1) << corner;
    const std::string obj = TempFolder::read(folder / "w.obj");
    std::size_t lines = 0;
    for (std::size_t at = 0; (at = obj.find("\nvn ", at)) != std::string::npos; ++at) ++lines;
    EXPECT_EQ(lines, 2u);
  }
}

// Errors name the file that was asked for, not the temporary one, and nothing stays.
TEST(KeptLook, TexturesOnAFullDisk) {
  for (const char* name : {"w.gltf", "w.glb"}) {
    const TempFolder folder;
    Scene scene = small_scene();
    scene.textures.resize(1);
    scene.textures[0].image = Image8(64, 64, 3);
    std::uint32_t noise = 1;  // does not compress
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        scene.textures[0].image.at(x, y)[0] = std::uint8_t((noise = noise * 1664525 + 1) >> 24);
    scene.materials[0].texture = 0;
    Status status;
    {
      AtomicFiles files;
      const FullDisk full(100);
      status = write_gltf(world_of(scene), folder / name, files, {}).status();
    }
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find((folder / "w").string()), std::string::npos);
    EXPECT_EQ(status.message().find(".part"), std::string::npos) << status.message();
    EXPECT_EQ(folder.count(), 0u);
  }
}

}  // namespace
}  // namespace atlas::test
