// Tests a World::scene that was read from glTF: textures, extensions and other parts of the
// document, one by one.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/exporters/gltf_layout.h"
#include "tests/exporters/kept_gltf.h"

namespace atlas::test {
namespace {

using Lines = std::vector<std::string>;

struct Kept {
  WorldFile written;
  json document;
};

Kept kept(const TempFolder& folder, const Gltf& gltf, const char* name = "w.glb") {
  Kept result;
  result.written = keep(folder.write("s.glb", gltf.glb()), folder / name);
  result.document = GltfOracle(folder / name).document;
  return result;
}

// A transform moves a texture to another set only if it says so.
TEST(KeptParts, TransformsWithoutASetLeaveTheTexturesOwn) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["materials"][0]["normalTexture"] = {
      {"index", 0},
      {"texCoord", 7},
      {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}};
  EXPECT_EQ(kept(folder, gltf).written.not_kept, Lines{kNoUvs});
}

// What only is called a texture, and does not refer to one, stays.
TEST(KeptParts, WhatIsNoReferenceToATextureStays) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  const json paint = {{"paintTexture", {{"grain", 3}}}};
  gltf.j["materials"][0]["extensions"]["ACME_paint"] = paint;
  gltf.j["textures"][0]["extensions"]["ACME_scan"] = {{"camera", "b"}};
  const Kept after = kept(folder, gltf);
  EXPECT_EQ(after.written.not_kept, Lines{});
  EXPECT_EQ(after.document["materials"][0]["extensions"]["ACME_paint"], paint);
  EXPECT_EQ(after.document["textures"][0]["extensions"]["ACME_scan"]["camera"], "b");
  EXPECT_EQ(after.document["textures"][0]["source"], 0);
}

// Images that cannot be read are left out, and the others get their numbers.
TEST(KeptParts, ImagesAreNumberedAnew) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  json& images = gltf.j["images"];
  images.insert(images.begin(), json{{"uri", "gone.png"}});
  gltf.j["textures"] = json::array({{{"source", 1}}, {{"source", 0}}});
  gltf.j["materials"][0]["normalTexture"] = {{"index", 1}};
  const Kept after = kept(folder, gltf);
  EXPECT_EQ(after.written.not_kept, Lines{kNoImage});
  EXPECT_EQ(after.document["images"].size(), 1u);
  EXPECT_EQ(after.document["textures"][0]["source"], 0);
  EXPECT_FALSE(after.document["textures"][1].contains("source"));
  gltf.j["images"] = json::array({{{"uri", "gone.png"}}});
  gltf.j["textures"] = json::array({{{"source", 0}}});
  gltf.j["materials"][0].erase("normalTexture");
  EXPECT_FALSE(kept(folder, gltf).document.contains("images"));
}

// An image that lay beside its file is embedded, and one that was embedded lies beside it.
TEST(KeptParts, ImagesHaveOnePlaceAndItsType) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  folder.write("beside.png", png_bytes(folder, 99));
  gltf.j["images"].push_back({{"uri", "beside.png"}, {"name", "b"}});
  gltf.j["textures"].push_back({{"source", 1}});
  gltf.j["materials"][0]["normalTexture"] = {{"index", 1}};
  for (const char* name : {"w.glb", "w.gltf"}) {
    const json after = kept(folder, gltf, name).document;
    ASSERT_EQ(after["images"].size(), 2u);
    for (const json& image : after["images"]) {
      const bool embedded = name == std::string("w.glb");
      EXPECT_EQ(image.contains("bufferView"), embedded);
      EXPECT_EQ(image.contains("mimeType"), embedded);
      EXPECT_EQ(image.contains("uri"), !embedded);
    }
    EXPECT_EQ(after["images"][1]["name"], "b");
  }
}

// Primitives that lack the same uvs share the material without its textures.
TEST(KeptParts, MaterialsWithoutTheirTexturesAreShared) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  json& primitives = gltf.j["meshes"][0]["primitives"];
  json bare = primitives[0];
  bare["attributes"].erase("TEXCOORD_0");
  primitives.push_back(bare);
  primitives.push_back(bare);
  const Kept after = kept(folder, gltf);
  EXPECT_EQ(after.written.not_kept, Lines{kNoUvs});
  EXPECT_EQ(after.document["materials"].size(), 2u);
  const json& written = after.document["meshes"][0]["primitives"];
  EXPECT_EQ(written[0]["material"], 0);
  EXPECT_EQ(written[1]["material"], 1);
  EXPECT_EQ(written[2]["material"], 1);
}

// Names like that of a uv set, which are none.
TEST(KeptParts, OtherAttributesAreNoUvSets) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  json& attributes = gltf.j["meshes"][0]["primitives"][0]["attributes"];
  for (const char* name : {"TEXCOORD_1x", "TEXCOORD_", "TEXCOORD_99999999999999"})
    attributes[name] = attributes["TEXCOORD_0"];
  EXPECT_EQ(kept(folder, gltf).written.uv_set, "TEXCOORD_1");
}

// Vertices are numbered anew, so what the source says of the place and the bounds of all of its
// rows no longer holds.
TEST(KeptParts, RowsAreWrittenAsTheyAreRead) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  const int all = gltf.view(std::vector<float>{9, 9, 1, 2, 3, 4, 5, 6, 70, 80}),
            which = gltf.view(std::vector<std::uint16_t>{1}),
            instead = gltf.view(std::vector<float>{30, 40});
  gltf.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      gltf.accessor({{"bufferView", all},
                     {"byteOffset", 8},
                     {"componentType", 5126},
                     {"type", "VEC2"},
                     {"count", 4},
                     {"min", {1, 2}},
                     {"max", {70, 80}},
                     {"sparse",
                      {{"count", 1},
                       {"indices", {{"bufferView", which}, {"componentType", 5123}}},
                       {"values", {{"bufferView", instead}}}}}});
  kept(folder, gltf);
  const GltfOracle after(folder / "w.glb");
  EXPECT_EQ(after.triangles().at(0).attributes.at("TEXCOORD_0"),
            (std::vector<double>{1, 2, 30, 40, 5, 6}));
  const json& number = after.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"];
  const json& accessor = after.document["accessors"][number.get<std::size_t>()];
  EXPECT_EQ(accessor.value("max", json{30, 40}), (json{30, 40}));
}

TEST(KeptParts, AttributesNeedARowForEachVertex) {
  for (const std::size_t rows : {2, 3}) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    gltf.j["meshes"][0]["primitives"][0]["attributes"]["_A"] =
        gltf.floats(std::vector<float>(rows, 7), "SCALAR", 1);
    const Kept after = kept(folder, gltf);
    EXPECT_EQ(after.written.not_kept.empty(), rows == 3);
    EXPECT_EQ(after.document["meshes"][0]["primitives"][0]["attributes"].contains("_A"), rows == 3);
  }
}

// Points are copied unless a part of their data is missing.
TEST(KeptParts, PointsNeedAllTheirData) {
  const std::function<void(Gltf&, json&)> spoils[] = {
      [](Gltf& gltf, json& points) {  // more indices than there are bytes
        points["indices"] = gltf.indices<std::uint16_t>({0, 1, 2});
        gltf.j["accessors"].back()["count"] = 100;
      },
      [](Gltf&, json& points) { points["attributes"]["_A"] = 99; },
      [](Gltf&, json& points) {
        points["targets"] = json::array({{{"POSITION", 99}}});
      },
      [](Gltf&, json& points) {
        const json good = {{"POSITION", points["attributes"]["POSITION"]}};
        points["targets"] = json::array({{{"POSITION", 99}}, good});
      },
  };
  for (const auto& spoil : spoils) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    json& primitives = gltf.j["meshes"][0]["primitives"];
    json points = {{"attributes", {{"POSITION", primitives[0]["attributes"]["POSITION"]}}},
                   {"mode", 0}};
    primitives.push_back(points);
    spoil(gltf, points);
    gltf.j["meshes"][0]["primitives"].push_back(points);
    const Kept after = kept(folder, gltf);
    EXPECT_EQ(after.written.not_kept, Lines{"1 x primitives whose data cannot be read"});
    EXPECT_EQ(after.document["meshes"][0]["primitives"].size(), 2u);
  }
}

// Each primitive has its own range of the scene's positions.
TEST(KeptParts, LightAndCornersBelongToTheirPrimitive) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["meshes"].push_back(gltf.j["meshes"][0]);
  gltf.j["nodes"].push_back({{"mesh", 1}});
  gltf.j["scenes"][0]["nodes"] = {0, 1};
  const auto input = folder.write("s.glb", gltf.glb());
  ReadOptions options = kGltfRest;
  options.illumination_file =
      folder.write("light.txt", "1 1 1\n2 2 2\n3 3 3\n4 4 4\n5 5 5\n6 6 6\n");
  keep(input, folder / "w.glb", options);
  const auto triangles = GltfOracle(folder / "w.glb").triangles();
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[1].attributes.at("_ILLUMINANCE"),
            (std::vector<double>{4, 4, 4, 5, 5, 5, 6, 6, 6}));
  for (const std::uint32_t other : {3u, 4u}) {
    auto loaded = read_scene(input, kGltfRest, {});
    ASSERT_TRUE(loaded.ok());
    ASSERT_EQ(loaded->scene.indices[3], 3u);
    loaded->scene.indices[0] = other;  // a corner of the second primitive
    EXPECT_EQ(write_kept(world_of(loaded->scene), folder / "v.glb").status().code(),
              ErrorCode::bad_input);
  }
}

// Colours of the file itself are no light of another one.
TEST(KeptParts, ColoursStayColours) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      gltf.floats({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3", 3);
  const json after = kept(folder, gltf).document;
  const json& attributes = after["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_TRUE(attributes.contains("COLOR_0"));
  EXPECT_FALSE(attributes.contains("_ILLUMINANCE"));
}

// Programs may put anything into extras. Extensions deep inside others hold data, too.
TEST(KeptParts, ExtensionsAreFoundWhereverTheyAre) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["nodes"][0]["extras"] = {{"extensions", {{"ACME_fake", json::object()}}}};
  json& extensions = gltf.j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  extensions["extensions"]["KHR_texture_transform"] = {{"offset", {0.5, 0}}};
  gltf.j["extensionsUsed"] = {"KHR_texture_transform", "ACME_deep"};
  gltf.j["extensionsRequired"] = {"KHR_texture_transform"};
  gltf.j["nodes"][0]["extensions"]["ACME_deep"] = {{"parts", {{{"bufferView", 0}}}}};
  const Kept after = kept(folder, gltf);
  EXPECT_EQ(after.written.not_kept, Lines{"1 x ACME_deep (an extension with data of its own)"});
  EXPECT_EQ(after.document["extensionsUsed"], json{"KHR_texture_transform"});
  EXPECT_EQ(after.document["extensionsRequired"], json{"KHR_texture_transform"});
}

// The instances of a node that is not shown are copied whole or not at all.
TEST(KeptParts, InstancesOfNodesThatAreNotShown) {
  for (const bool whole : {true, false}) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    const std::vector<float> turns{0, 0, 0, 1, 0, 1, 0, 0}, sizes{1, 2, 3, 4, 5, 6};
    json attributes = {{"ROTATION", gltf.floats(turns, "VEC4", 4)},
                       {"SCALE", gltf.floats(sizes, "VEC3", 3)}};
    if (!whole) attributes["TRANSLATION"] = 99;
    gltf.j["meshes"].push_back(gltf.j["meshes"][0]);
    gltf.j["nodes"].push_back(
        {{"mesh", 1}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
    gltf.j["scenes"].push_back({{"nodes", {1}}});
    const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
    const GltfOracle after(folder / "w.glb");
    const json& extensions = after.document["nodes"][1].value("extensions", json::object());
    EXPECT_EQ(extensions.contains("EXT_mesh_gpu_instancing"), whole);
    EXPECT_EQ(written.not_kept.size(), whole ? 0u : 1u);
    if (!whole) continue;
    const json& now = extensions["EXT_mesh_gpu_instancing"]["attributes"];
    const auto expect = [&](const char* name, const std::vector<float>& values) {
      EXPECT_EQ(after.values(now[name]), std::vector<double>(values.begin(), values.end()));
    };
    expect("ROTATION", turns);
    expect("SCALE", sizes);
  }
}

TEST(KeptParts, TitlesAndGenerators) {
  for (const bool titled : {true, false}) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    gltf.j["asset"]["generator"] = "some modeller";
    if (titled) gltf.j["asset"]["extras"]["title"] = "theirs";
    const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
    ASSERT_TRUE(loaded.ok());
    World world = world_of(loaded->scene);
    world.title = "ours";
    ASSERT_TRUE(write_kept(world, folder / "w.glb").ok());
    const json asset = GltfOracle(folder / "w.glb").document["asset"];
    EXPECT_EQ(asset["extras"]["title"], titled ? "theirs" : "ours");
    EXPECT_EQ(asset["generator"], "libatlas");
  }
}

// What morph targets do to uvs that are replaced is counted. A target that did nothing else stays,
// because meshes have a weight for each, and moves nothing.
TEST(KeptParts, UvsOfMorphTargetsThatAreReplacedAreTold) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  json& primitive = gltf.j["meshes"][0]["primitives"][0];
  const int uvs = primitive["attributes"]["TEXCOORD_0"];
  const int moves = primitive["attributes"]["POSITION"];
  primitive["attributes"]["TEXCOORD_1"] = uvs;
  primitive["targets"] = {{{"TEXCOORD_1", uvs}},
                          {{"POSITION", moves}, {"TEXCOORD_0", uvs}, {"TEXCOORD_1", uvs}},
                          {{"POSITION", moves}}};
  const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  World world = world_of(loaded->scene);
  const auto targets_of = [&](const Lines& not_kept) {
    const auto written = write_kept(world, folder / "w.glb");
    EXPECT_TRUE(written.ok()) << written.status().message();
    EXPECT_EQ(written->not_kept, not_kept);
    expect_gltf_layout(folder / "w.glb");
    const GltfOracle after(folder / "w.glb");
    return after.document["meshes"][0]["primitives"][0]["targets"];
  };
  EXPECT_TRUE(targets_of({})[0].contains("TEXCOORD_1"));
  world.uv_set = 1;
  const json targets = targets_of({"2 x uvs of morph targets, replaced"});
  ASSERT_EQ(targets.size(), 3u);
  ASSERT_TRUE(targets[0].contains("POSITION"));
  EXPECT_FALSE(targets[0].contains("TEXCOORD_1") || targets[1].contains("TEXCOORD_1"));
  EXPECT_TRUE(targets[1].contains("POSITION") && targets[1].contains("TEXCOORD_0"));
  const json zeros =
      GltfOracle(folder / "w.glb").document["accessors"][targets[0]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(zeros["count"], 3);
  EXPECT_EQ(zeros["max"], json({0, 0, 0}));
  EXPECT_FALSE(zeros.contains("bufferView"));
  EXPECT_TRUE(read_scene(folder / "w.glb", {}, {}).ok());
}

}  // namespace
}  // namespace atlas::test
