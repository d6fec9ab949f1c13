// Tests World::scene: what is wrong with a file does no harm.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/leaks.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

TEST(KeptDefects, AMaterialThatIsNotThereIsLeftOut) {
  for (const std::size_t beyond : {0, 1, 7}) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    gltf.j["meshes"][0]["primitives"][0]["material"] = gltf.j["materials"].size() + beyond;
    keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
    const json after = GltfOracle(folder / "w.glb").document;
    EXPECT_FALSE(after["meshes"][0]["primitives"][0].contains("material")) << beyond;
  }
}

// What names a mesh by its number names the same one afterwards, or nothing.
TEST(KeptDefects, MeshesAreFollowedWhenOthersAreLeftOut) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  const json attributes = gltf.j["meshes"][0]["primitives"][0]["attributes"];
  gltf.j["meshes"] = json::array(
      {{{"name", "broken"},
        {"primitives", json::array({{{"attributes", attributes},
                                     {"indices", gltf.indices<std::uint16_t>({50, 51, 52})}}})}},
       gltf.j["meshes"][0]});
  gltf.j["meshes"][1]["name"] = "whole";
  const auto shape = [](int mesh) {
    return json{{"type", "trimesh"}, {"trimesh", {{"mesh", mesh}}}};
  };
  gltf.j["extensions"]["OMI_physics_shape"]["shapes"] = {shape(0), shape(1)};
  gltf.j["extras"] = {{"mesh", 1}, {"extensions", {{"mesh", 1}}}};
  const int times = gltf.floats({0, 1}, "SCALAR", 1);
  const auto pointer = [](const std::string& to) {
    return json{
        {"sampler", 0},
        {"target",
         {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", to}}}}}}}};
  };
  const auto weights = [](int node) {
    return json{{"sampler", 0}, {"target", {{"path", "weights"}, {"node", node}}}};
  };
  const json samplers = json::array({{{"input", times}, {"output", times}}});
  gltf.j["animations"] = json::array(
      {{{"samplers", samplers},
        {"channels",
         {pointer("/meshes/0/weights"), pointer("/meshes/1/weights"), weights(0), weights(1),
          pointer("/nodes/0/weights/0"), pointer("/nodes/0/translation"), pointer("/meshes/1x")}}},
       {{"samplers", samplers}, {"channels", json::array({weights(0)})}}});
  gltf.j["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 1}}});
  gltf.j["scenes"][0]["nodes"] = {0, 1};
  const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  EXPECT_EQ(written.not_kept,
            (std::vector<std::string>{
                "4 x animations of meshes of which no primitive is left",
                "1 x meshes of which no primitive is left",
                "1 x parts of extensions that name a mesh of which no primitive is left"}));
  const json after = GltfOracle(folder / "w.glb").document;
  EXPECT_EQ(after["meshes"][0]["name"], "whole");
  ASSERT_EQ(after["animations"].size(), 1u);
  EXPECT_EQ(after["animations"][0]["channels"],
            (json{pointer("/meshes/0/weights"), weights(1), pointer("/nodes/0/translation"),
                  pointer("/meshes/1x")}));
  const json& shapes = after["extensions"]["OMI_physics_shape"]["shapes"];
  EXPECT_EQ(shapes[0]["trimesh"], json::object());
  EXPECT_EQ(shapes[1], shape(0));
  EXPECT_EQ(after["extras"], gltf.j["extras"]);
}

// The format has no mesh without a primitive.
TEST(KeptDefects, MeshesOfDefectsOnlyAreLeftOut) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  const json attributes = gltf.j["meshes"][0]["primitives"][0]["attributes"];
  const int matrices = gltf.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 16);
  gltf.j["skins"] = json::array({{{"joints", {0}}, {"inverseBindMatrices", matrices}}});
  gltf.j["meshes"] = json::array(
      {{{"name", "broken"},
        {"primitives", json::array({{{"attributes", attributes},
                                     {"indices", gltf.indices<std::uint16_t>({50, 51, 52})}}})}},
       gltf.j["meshes"][0]});
  gltf.j["nodes"] = json::array(
      {{{"name", "a"}, {"mesh", 0}, {"skin", 0}, {"children", {1}}}, {{"name", "b"}, {"mesh", 1}}});
  const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  EXPECT_EQ(written.not_kept, std::vector<std::string>{"1 x meshes of which no primitive is left"});
  const json after = GltfOracle(folder / "w.glb").document;
  EXPECT_EQ(after["nodes"][0]["name"], "a");
  EXPECT_FALSE(after["nodes"][0].contains("mesh"));
  EXPECT_FALSE(after["nodes"][0].contains("skin"));
  EXPECT_EQ(after["meshes"].size(), 1u);
  EXPECT_EQ(after["nodes"].at(1)["mesh"], 0);
  EXPECT_EQ(GltfOracle(folder / "w.glb").triangles().size(), 1u);
}

// Triangles that are left out stay out, and the others keep their corners.
TEST(KeptDefects, DefectiveTrianglesAreLeftOut) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  json& primitive = gltf.j["meshes"][0]["primitives"][0];
  primitive["indices"] = gltf.indices<std::uint16_t>({0, 1, 77, 2, 0, 1, 0, 1, 2, 9, 9, 9});
  gltf.j["meshes"][0]["primitives"].push_back(
      {{"attributes", primitive["attributes"]},
       {"indices", gltf.indices<std::uint16_t>({50, 51, 52})}});
  keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  const auto triangles = GltfOracle(folder / "w.glb").triangles();
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[0].attributes.at("POSITION"),
            (std::vector<double>{0, 1, 0, 0, 0, 0, 1, 0, 0}));
  EXPECT_EQ(triangles[1].attributes.at("TEXCOORD_1")[0], 3.0 / 64);
}

// Whatever happens to the bytes, the result is an error or a file that can be read.
TEST(KeptDefects, DamagedFilesAreWrittenSoundOrRefused) {
  const TempFolder folder;
  const test::IgnoreLeaks reader;  // libpng leaves OpenImageIO's functions by longjmp
  Gltf gltf = textured(folder);
  gltf.j["skins"] = json::array({{{"joints", {0}}, {"inverseBindMatrices", 0}}});
  gltf.j["animations"] =
      json::array({{{"channels", json::array()}, {"samplers", {{{"input", 0}, {"output", 0}}}}}});
  gltf.j["extensions"]["KHR_lights_punctual"] = {{"lights", json::array({{{"type", "point"}}})}};
  gltf.j["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 0}};
  gltf.j["samplers"] = json::array({json::object()});
  const std::string good = gltf.glb();
  ASSERT_EQ(read_scene(folder.write("d.glb", good), kGltfRest, {}).status().message(), "");
  // Digits of the JSON: changing them refers to other elements, or to none.
  std::vector<std::size_t> digits;
  for (std::size_t i = 20; i < good.find("BIN"); ++i)
    if (good[i] >= '0' && good[i] <= '9') digits.push_back(i);
  std::mt19937 random(11);
  int written = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string bytes = good;
    for (int k = 0; k < 1 + round % 3; ++k) {
      if (round % 4 != 0)
        bytes[digits[random() % digits.size()]] = "0123456789-"[random() % 11];
      else
        bytes[20 + random() % (bytes.size() - 20)] = char(random());
    }
    const auto loaded = read_scene(folder.write("d.glb", bytes), kGltfRest, {});
    if (!loaded.ok()) continue;
    const World world = world_of(loaded->scene);
    const auto result = write_kept(world, folder / "w.glb");
    ASSERT_TRUE(result.ok()) << round << ": " << result.status().message();
    const auto back = read_scene(folder / "w.glb", {}, {});
    ASSERT_TRUE(back.ok()) << round << ": " << back.status().message();
    EXPECT_EQ(back->scene.triangle_count(), loaded->scene.triangle_count()) << round;
    ++written;
  }
  EXPECT_GT(written, 100);
}

}  // namespace
}  // namespace atlas::test
