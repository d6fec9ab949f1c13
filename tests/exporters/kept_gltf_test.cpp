// Tests a World::scene that was read from glTF: compares the written file with the one that was
// read, with an independent reader.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "libatlas/scene/reader.h"
#include "libatlas/scene/uv_page.h"
#include "tests/exporters/gltf_layout.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using std::filesystem::path;

void add_image(Gltf& gltf, const std::string& bytes) {
  const int view = gltf.view(std::vector<char>(bytes.begin(), bytes.end()));
  gltf.j["images"].push_back(
      {{"bufferView", view}, {"mimeType", "image/png"}, {"name", "picture"}});
}

// A square of two triangles with every attribute of glTF, some of them in small integers.
json rich_attributes(Gltf& gltf) {
  json a = {{"POSITION", gltf.floats(kSquare, "VEC3", 3)}};
  // These are not all unit vectors. They must be written as the file has them.
  a["NORMAL"] = gltf.floats({0, 0, 1, 0, 0, 2, 0, 0, 0, 0.6f, 0, 0.8f}, "VEC3", 3);
  a["TANGENT"] = gltf.floats({1, 0, 0, 1, 1, 0, 0, -1, 0, 1, 0, 1, 0, 1, 0, -1}, "VEC4", 4);
  a["TEXCOORD_0"] = gltf.floats({0, 0, 3, 0, 3, 3, 0, 3}, "VEC2", 2);
  a["COLOR_0"] = gltf.accessor(
      {{"bufferView",
        gltf.view(std::vector<std::uint8_t>{255, 0, 0, 9, 0, 255, 0, 9, 0, 0, 255, 9, 5, 6, 7, 9},
                  4)},
       {"componentType", 5121},
       {"normalized", true},
       {"type", "VEC3"},
       {"count", 4}});
  a["TEXCOORD_1"] = gltf.accessor({{"bufferView", gltf.view(std::vector<std::uint16_t>{
                                                      0, 0, 65535, 0, 65535, 65535, 0, 65535})},
                                   {"componentType", 5123},
                                   {"normalized", true},
                                   {"type", "VEC2"},
                                   {"count", 4}});
  a["JOINTS_0"] = gltf.accessor({{"bufferView", gltf.view(std::vector<std::uint8_t>(16, 0))},
                                 {"componentType", 5121},
                                 {"type", "VEC4"},
                                 {"count", 4}});
  a["WEIGHTS_0"] = gltf.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  a["_HEAT"] = gltf.floats({1, 2, 3, 4}, "SCALAR", 1);
  return a;
}

json rich_material() {
  const json moved = {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"texCoord", 1}}}};
  return {{"name", "paint"},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {0.5, 0.25, 1, 0.75}},
            {"baseColorTexture", {{"index", 0}, {"extensions", moved}}},
            {"metallicFactor", 0.25},
            {"roughnessFactor", 0.125},
            {"metallicRoughnessTexture", {{"index", 1}, {"texCoord", 1}}}}},
          {"normalTexture", {{"index", 1}, {"scale", 0.5}}},
          {"occlusionTexture", {{"index", 0}, {"texCoord", 1}, {"strength", 0.75}}},
          {"emissiveTexture", {{"index", 0}}},
          {"emissiveFactor", {1, 0.5, 0}},
          {"alphaMode", "MASK"},
          {"alphaCutoff", 0.25},
          {"doubleSided", true},
          {"extras", {{"anyTexture", {{"index", 99}}}}},
          {"extensions",
           {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}},
            {"KHR_materials_ior", {{"ior", 1.25}}},
            {"KHR_materials_clearcoat",
             {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", {{"index", 1}, {"scale", 2}}}}},
            {"KHR_materials_transmission", {{"transmissionTexture", {{"index", 0}}}}},
            {"KHR_materials_sheen", {{"sheenColorFactor", {1, 0, 0}}}}}}};
}

// Adds two textures with samplers; the image of the second is in the file twice.
void add_textures(Gltf& gltf, const TempFolder& folder) {
  add_image(gltf, png_bytes(folder, 40));
  add_image(gltf, png_bytes(folder, 90));
  gltf.j["samplers"] = json::array({{{"wrapS", 33071}, {"magFilter", 9728}}, {{"wrapT", 33648}}});
  gltf.j["textures"] = json::array(
      {{{"source", 1}, {"sampler", 1}, {"name", "t"}}, {{"source", 0}, {"sampler", 0}}});
}

// A tree of nodes that shows one mesh twice, once mirrored, with a skin, an animation, morph
// targets, a camera, a light, points, and another scene.
Gltf rich_file(const TempFolder& folder) {
  Gltf gltf;
  add_textures(gltf, folder);
  gltf.j["materials"] =
      json::array({rich_material(), {{"extensions", {{"KHR_materials_unlit", json::object()}}}}});
  const json attributes = rich_attributes(gltf);
  const int indices = gltf.indices<std::uint16_t>({0, 1, 2, 0, 2, 3});
  const int move = gltf.floats({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 2}, "VEC3", 3);
  const json square = {{"attributes", attributes},
                       {"indices", indices},
                       {"material", 0},
                       {"targets", {{{"POSITION", move}}}},
                       {"extras", {{"own", 1}}}};
  json strip = {{"attributes", {{"POSITION", attributes["POSITION"]}}}, {"mode", 5}};
  const json points = {{"attributes", {{"POSITION", attributes["POSITION"]}}}, {"mode", 0}};
  gltf.j["meshes"] =
      json::array({{{"name", "m"}, {"primitives", {points, square, strip}}, {"weights", {0}}},
                   {{"name", "elsewhere"}, {"primitives", {strip}}}});
  gltf.j["nodes"] = json::array(
      {{{"name", "top"}, {"children", {1, 2}}, {"translation", {100, 0, 0}}, {"extras", {1, 2}}},
       {{"name", "left"}, {"mesh", 0}, {"rotation", {0, 0.6, 0, 0.8}}},
       {{"name", "right"},
        {"mesh", 0},
        {"children", {3}},
        {"matrix", {-2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}},
       {{"name", "eye"}, {"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
       {{"name", "other scene"}, {"mesh", 1}}});
  gltf.j["scenes"] = json::array({{{"nodes", {4}}}, {{"name", "shown"}, {"nodes", {0}}}});
  gltf.j["scene"] = 1;
  gltf.j["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}});
  gltf.j["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
  const int times = gltf.floats({0, 1}, "SCALAR", 1);
  const int turns = gltf.floats({0, 0, 0, 1, 0, 1, 0, 0}, "VEC4", 4);
  gltf.j["animations"] = json::array(
      {{{"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}},
        {"samplers", {{{"input", times}, {"output", turns}}}}}});
  const int inverse = gltf.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 16);
  gltf.j["skins"] = json::array({{{"joints", {3}}, {"inverseBindMatrices", inverse}}});
  gltf.j["asset"]["copyright"] = "somebody";
  gltf.j["asset"]["extras"] = {{"title", "theirs"}};
  gltf.j["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_unlit",
                              "KHR_mesh_quantization"};
  return gltf;
}

// Removes the numbers of data, which may change.
json without_data(json document) {
  for (const char* list : {"accessors", "bufferViews", "buffers", "extensionsUsed"})
    document.erase(list);
  for (json& image : document["images"]) {
    image.erase("bufferView");
    image.erase("uri");
    image.erase("mimeType");
  }
  for (json& animation : document["animations"])
    for (json& sampler : animation["samplers"]) sampler = nullptr;
  for (json& skin : document["skins"]) skin.erase("inverseBindMatrices");
  document.erase("meshes");
  document.erase("asset");
  return document;
}

// Turns strips into lists, since the oracle reads nothing else.
Gltf with_lists(Gltf gltf) {
  const int list = gltf.indices<std::uint16_t>({0, 1, 2, 2, 1, 3});
  for (json& mesh : gltf.j["meshes"]) {
    json& strip = mesh["primitives"].back();
    strip.erase("mode");
    strip["indices"] = list;
  }
  return gltf;
}

TEST(KeptGltf, IsTheFileThatItWas) {
  for (const char* name : {"w.glb", "w.gltf"}) {
    const TempFolder folder;
    const Gltf gltf = rich_file(folder);
    const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / name);
    const GltfOracle before(folder.write("lists.glb", with_lists(gltf).glb()));
    const GltfOracle after(folder / name);
    EXPECT_EQ(written.uv_set, "TEXCOORD_2");
    EXPECT_EQ(written.not_kept, std::vector<std::string>{});
    EXPECT_EQ(written.meshes_without_uvs, 1u);
    expect_kept(before.triangles(), after.triangles(), "TEXCOORD_2");
    json expected = without_data(before.document), is = without_data(after.document);
    // The mirrored node gets a mesh of its own.
    EXPECT_EQ(is["nodes"][2]["mesh"], 2);
    is["nodes"][2]["mesh"] = 0;
    EXPECT_EQ(is, expected) << json::diff(expected, is).dump(1);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(before.image(i), after.image(i));
      const json& image = after.document["images"][i];
      EXPECT_NE(image.contains("uri"), image.contains("bufferView")) << "one place only";
    }
    expect_gltf_layout(folder / name);
    const json& sampler = after.document["animations"][0]["samplers"][0];
    const json& had = before.document["animations"][0]["samplers"][0];
    for (const char* key : {"input", "output"})
      EXPECT_EQ(after.values(sampler[key]), before.values(had[key]));
    EXPECT_EQ(after.values(after.document["skins"][0]["inverseBindMatrices"]),
              before.values(before.document["skins"][0]["inverseBindMatrices"]));
  }
}

TEST(KeptGltf, HasItsMeshesAssetAndExtensions) {
  const TempFolder folder;
  keep(folder.write("s.glb", rich_file(folder).glb()), folder / "w.glb");
  const json after = GltfOracle(folder / "w.glb").document;
  EXPECT_EQ(after["asset"]["copyright"], "somebody");
  EXPECT_EQ(after["asset"]["extras"]["title"], "theirs");
  EXPECT_NE(after["asset"]["extras"]["info"].dump().find("TEXCOORD_2"), std::string::npos);
  ASSERT_EQ(after["meshes"].size(), 3u);
  for (const std::size_t m : {0, 2}) {
    const json& mesh = after["meshes"][m];
    EXPECT_EQ(mesh["name"], "m");
    EXPECT_EQ(mesh["weights"], json::array({0}));
    ASSERT_EQ(mesh["primitives"].size(), 3u);
    EXPECT_EQ(mesh["primitives"][0]["mode"], 0);  // points stay as they are
    EXPECT_FALSE(mesh["primitives"][0]["attributes"].contains("TEXCOORD_2"));
    EXPECT_EQ(mesh["primitives"][1]["extras"], json({{"own", 1}}));
    EXPECT_EQ(mesh["primitives"][1]["targets"].size(), 1u);
    // Sets before the new one that a primitive lacks are filled with the new one.
    const json& strip = mesh["primitives"][2]["attributes"];
    EXPECT_EQ(strip["TEXCOORD_0"], strip["TEXCOORD_2"]);
    EXPECT_EQ(strip["TEXCOORD_1"], strip["TEXCOORD_2"]);
  }
  EXPECT_EQ(after["meshes"][1]["primitives"][0]["mode"], 5);
  const std::set<std::string> used = after["extensionsUsed"];
  for (const char* name : {"KHR_materials_ior", "KHR_materials_unlit", "KHR_texture_transform",
                           "KHR_mesh_quantization", "KHR_lights_punctual"})
    EXPECT_TRUE(used.contains(name)) << name;
  // There is one vertex for each corner, since all corners have uvs of their own here.
  for (const json& accessor : after["accessors"])
    EXPECT_TRUE(!accessor.contains("max") || accessor["count"] == 6) << accessor;
}

// Other information in a file stays. What an earlier export said about its uvs is replaced.
TEST(KeptGltf, InformationIsAdded) {
  const struct {
    json asset, info;
  } cases[] = {
      {{{"version", "2.0"}}, {"the new uvs: TEXCOORD_1"}},
      {{{"version", "2.0"}, {"extras", {{"info", "theirs"}}}},
       {"theirs", "the new uvs: TEXCOORD_1"}},
      {{{"version", "2.0"}, {"extras", {{"info", {"a", 2}}}}}, {"a", 2, "the new uvs: TEXCOORD_1"}},
      {{{"version", "2.0"}, {"generator", "libatlas"}, {"extras", {{"info", {"old"}}}}},
       {"the new uvs: TEXCOORD_1"}},
      {{{"version", "2.0"}, {"extras", 5}}, {"the new uvs: TEXCOORD_1"}}};
  for (const auto& c : cases) {
    const TempFolder folder;
    Gltf gltf;
    gltf.single(
        {{"attributes", {{"POSITION", gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}}});
    gltf.j["asset"] = c.asset;
    keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
    EXPECT_EQ(GltfOracle(folder / "w.glb").document["asset"]["extras"]["info"], c.info);
  }
}

// Of an earlier export's information, the pages of the sets that stay are still true. Lines that
// name no set are about the first one.
TEST(KeptGltf, PagesOfItsUvsNameTheirSets) {
  const std::string wide = uv_page_text(40, 10), high = uv_page_text(10, 40);
  const struct {
    std::vector<std::string> info, wanted;
    int uv_set;
    bool ours;
  } cases[] = {
      {{}, {of_uv_set(1, wide)}, 0, false},
      {{high, "theirs"}, {of_uv_set(0, high), "theirs", of_uv_set(1, wide)}, 0, false},
      {{uv_page_text(0, 8, 4), "old"},
       {of_uv_set(0, uv_page_text(0, 8, 4)), of_uv_set(1, wide)},
       0,
       true},
      {{of_uv_set(1, high), of_uv_set(2, high)}, {of_uv_set(2, high), of_uv_set(1, wide)}, 1, true},
      {{of_uv_set(1, high)}, {of_uv_set(1, wide)}, 1, false}};
  for (const auto& c : cases) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    if (c.ours) gltf.j["asset"]["generator"] = "libatlas";
    gltf.j["asset"]["extras"]["info"] = c.info;
    const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    World world = world_of(loaded->scene);
    world.info = {wide};
    world.uv_set = c.uv_set;
    ASSERT_TRUE(write_kept(world, folder / "w.glb").ok());
    json info = GltfOracle(folder / "w.glb").document["asset"]["extras"]["info"];
    EXPECT_EQ(info.back(), "the new uvs: TEXCOORD_1");
    info.erase(info.size() - 1);
    EXPECT_EQ(info, json(c.wanted));
  }
}

// What the library reads from both files is the same, corner by corner, in world coordinates.
TEST(KeptGltf, StandsWhereItStoodWithTheNewUvsAtItsCorners) {
  const TempFolder folder;
  const path input = folder.write("s.glb", rich_file(folder).glb());
  keep(input, folder / "w.glb");
  const auto before = read_scene(input, kGltfRest, {}),
             after = read_scene(folder / "w.glb", kGltfRest, {});
  ASSERT_TRUE(before.ok() && after.ok());
  ASSERT_EQ(before->scene.indices.size(), after->scene.indices.size());
  for (std::size_t k = 0; k < before->scene.indices.size(); ++k)
    EXPECT_EQ(before->scene.positions[before->scene.indices[k]],
              after->scene.positions[after->scene.indices[k]]);
  EXPECT_EQ(before->scene.object_names, after->scene.object_names);
  // The corners of the mirrored node's triangles are in the opposite order in the scene.
  const auto triangles = GltfOracle(folder / "w.glb").triangles();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const bool mirrored = triangles[t].node == "right";
    const auto& uvs = triangles[t].attributes.at("TEXCOORD_2");
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t k = 3 * t + (mirrored ? 2 - c : c);
      EXPECT_EQ(uvs[2 * c], double(k) / 64);
      EXPECT_EQ(uvs[2 * c + 1], double(k) / 32);
    }
  }
}

}  // namespace
}  // namespace atlas::test
