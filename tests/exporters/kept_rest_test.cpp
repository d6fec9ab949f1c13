// Tests World::scene: what cannot be kept is reported, and what has changed is refused.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using std::filesystem::path;
using Lines = std::vector<std::string>;

const ReadOptions kRest{
    .unlit_textures = true, .encoded_textures = true, .normals = true, .rest = true};

TEST(KeptRest, TexturesThatAreNotThereAreToldAndLeftOut) {
  const struct {
    const char* line;
    std::function<void(json&)> spoil;
  } cases[] = {
      {kNoImage,
       [](json& j) {
         j["materials"][0]["normalTexture"] = {{"index", 99}};
       }},
      {kNoImage,
       [](json& j) {
         j["materials"][0]["normalTexture"] = {{"index", -3}};
       }},
      {kNoImage,
       [](json& j) {
         j["materials"][0]["normalTexture"] = {{"index", 1.5}};
       }},
      {kNoImage,
       [](json& j) {
         j["images"].push_back({{"uri", "gone.png"}});
         j["textures"].push_back({{"source", 1}});
         j["materials"][0]["normalTexture"] = {{"index", 1}};
       }},
      {kNoImage,
       [](json& j) {
         j["textures"].push_back({{"source", 7}});
         j["materials"][0]["normalTexture"] = {{"index", 1}};
       }},
      {kNoUvs,
       [](json& j) {
         j["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 7}};
       }},
      {kNoUvs,
       [](json& j) {  // this is the new set, not one of the material's
         j["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 1}};
       }},
      {kNoUvs,
       [](json& j) {
         j["materials"][0]["normalTexture"] = {
             {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"texCoord", 2}}}}}};
       }},
      {kNoUvs,
       [](json& j) {
         j["materials"][0]["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"] = {
             {"index", 0}, {"texCoord", 3}};
       }},
  };
  for (const auto& c : cases) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    c.spoil(gltf.j);
    const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
    EXPECT_EQ(written.not_kept, Lines{c.line});
    const GltfOracle after(folder / "w.glb");
    const auto triangles = after.triangles();
    const json& material = after.document["materials"].at(std::size_t(triangles[0].material));
    EXPECT_FALSE(material.contains("normalTexture"));
    EXPECT_EQ(material.dump().find("clearcoatTexture"), std::string::npos);
    EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
    EXPECT_EQ(after.document["textures"][0]["source"], 0);
  }
}

// Parts of a file that refer to the data of an extension make no sense without it.
TEST(KeptRest, ExtensionsAreLeftOutWithWhatRefersToThem) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["extensions"]["ACME_shaders"] = {{"code", {{{"bufferView", 0}}}}};
  gltf.j["extensions"]["ACME_other"] = {{"names", {"a"}}};
  for (const char* name : {"ACME_shaders", "ACME_other"})
    gltf.j["materials"][0]["extensions"][name] = {{"shader", 0}};
  gltf.j["nodes"][0]["extensions"]["ACME_shaders"] = {{"shader", 0}};
  gltf.j["nodes"][0]["extras"]["extensions"]["ACME_shaders"] = 7;
  gltf.j["extensionsUsed"] = {"ACME_shaders", "ACME_other"};
  const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  EXPECT_EQ(written.not_kept, (Lines{"1 x ACME_shaders (an extension with data of its own)",
                                     "2 x parts that refer to the data of ACME_shaders"}));
  const json after = GltfOracle(folder / "w.glb").document;
  EXPECT_EQ(after["extensions"], (json{{"ACME_other", {{"names", {"a"}}}}}));
  EXPECT_EQ(after["materials"][0]["extensions"], (json{{"ACME_other", {{"shader", 0}}}}));
  EXPECT_FALSE(after["nodes"][0].contains("extensions"));
  EXPECT_EQ(after["nodes"][0]["extras"], gltf.j["nodes"][0]["extras"]);
  EXPECT_EQ(after["extensionsUsed"], json{"ACME_other"});
}

TEST(KeptRest, DataThatIsNotThereIsToldAndLeftOut) {
  const struct {
    const char* line;
    std::function<void(json&)> spoil;
  } cases[] = {
      {"1 x animations whose data cannot be read",
       [](json& j) {
         j["animations"] = json::array(
             {{{"channels", json::array()}, {"samplers", {{{"input", 77}, {"output", 0}}}}}});
       }},
      {"1 x matrices of skins that cannot be read",
       [](json& j) {
         j["skins"] = json::array({{{"joints", {0}}, {"inverseBindMatrices", 99}}});
       }},
      {"1 x attributes that are shorter than their positions",
       [](json& j) { j["meshes"][0]["primitives"][0]["attributes"]["_A"] = 99; }},
      {"1 x primitives whose data cannot be read",
       [](json& j) {
         j["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 99}}}, {"mode", 0}});
       }},
      {"1 x EXT_structural_metadata (an extension with data of its own)",
       [](json& j) {
         j["extensions"]["EXT_structural_metadata"] = {{"schema", "s"}};
       }},
      {"1 x ACME_outline (an extension with data of its own)",
       [](json& j) {
         j["meshes"][0]["primitives"][0]["extensions"]["ACME_outline"] = {{"indices", 0}};
       }},
      {"1 x ACME_outline (an extension with data of its own)",
       [](json& j) {
         j["meshes"][0]["extensions"]["ACME_outline"] = {{"indices", 0}};
       }},
      {"1 x ACME_outline (an extension with data of its own)",
       [](json& j) {
         j["nodes"][0]["extensions"]["ACME_outline"] = {{"indices", 0}};
       }},
      {"1 x ACME_outline (an extension with data of its own)",
       [](json& j) {  // of points, which are copied
         json& primitives = j["meshes"][0]["primitives"];
         const json positions = {{"POSITION", primitives[0]["attributes"]["POSITION"]}};
         primitives.push_back({{"attributes", positions},
                               {"mode", 0},
                               {"extensions", {{"ACME_outline", {{"indices", 0}}}}}});
       }},
      {"1 x KHR_draco_mesh_compression (an extension with data of its own)",
       [](json& j) {
         j["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
             {"bufferView", 0}, {"attributes", json::object()}};
       }},
  };
  for (const auto& c : cases) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    c.spoil(gltf.j);
    const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
    EXPECT_EQ(written.not_kept, Lines{c.line});
    const GltfOracle after(folder / "w.glb");
    EXPECT_EQ(after.triangles().size(), 1u);
    EXPECT_EQ(after.document.dump().find("99"), std::string::npos);
    EXPECT_FALSE(after.document.contains("extensionsUsed"));
  }
}

// What another scene shows is copied as it is: sparse positions, morph targets, and the instances
// of a node.
TEST(KeptRest, OtherScenesKeepAllTheirData) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  const std::vector<float> rest{1, 2, 3, 4, 5, 6, 7, 8, 9}, moved{40, 50, 60};
  const int all = gltf.view(rest), which = gltf.view(std::vector<std::uint16_t>{1}),
            instead = gltf.view(moved);
  const int positions =
      gltf.accessor({{"bufferView", all},
                     {"componentType", 5126},
                     {"type", "VEC3"},
                     {"count", 3},
                     {"sparse",
                      {{"count", 1},
                       {"indices", {{"bufferView", which}, {"componentType", 5123}}},
                       {"values", {{"bufferView", instead}}}}}});
  const std::vector<float> target{0, 0, 1, 0, 1, 0, 1, 0, 0}, places{0, 0, 0, 9, 8, 7};
  const json morph = {{"POSITION", gltf.floats(target, "VEC3", 3)}};
  const json stars = {
      {"attributes", {{"POSITION", positions}}}, {"mode", 0}, {"targets", json::array({morph})}};
  gltf.j["meshes"].push_back({{"name", "stars"}, {"primitives", json::array({stars})}});
  // Accessors get other numbers, so those of attributes that only programs know must be followed.
  const std::vector<float> ids{17, 18};
  const int id = gltf.floats(ids, "SCALAR", 1);
  const json instances = {
      {"TRANSLATION", gltf.floats(places, "VEC3", 3)}, {"_ID", id}, {"_GONE", 99}};
  gltf.j["nodes"].push_back(
      {{"mesh", 1},
       {"name", "sky"},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", instances}}}}}});
  gltf.j["scenes"].push_back({{"nodes", {1}}});  // it is not shown
  gltf.j["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const path in = folder.write("s.glb", gltf.glb());
  const WorldFile written = keep(in, folder / "w.glb");
  EXPECT_EQ(written.not_kept, Lines{"1 x attributes of instances whose data cannot be read"});
  EXPECT_EQ(written.meshes_without_uvs, 1u);

  GltfOracle after(folder / "w.glb");
  const auto named = [&](const char* list, const char* name) -> const json& {
    for (const json& item : after.document[list])
      if (item.value("name", "") == name) return item;
    throw std::runtime_error(name);
  };
  const auto values = [&](const json& number) {
    const std::vector<double> read = after.values(number);
    return std::vector<float>(read.begin(), read.end());
  };
  const json& points = named("meshes", "stars")["primitives"][0];
  EXPECT_EQ(values(points["targets"][0]["POSITION"]), target);
  const json& node = named("nodes", "sky");
  EXPECT_EQ(values(node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"]),
            places);
  const json& others = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  EXPECT_EQ(values(others["_ID"]), ids);
  EXPECT_FALSE(others.contains("_GONE"));
  json& sparse = after.document["accessors"][points["attributes"]["POSITION"].get<std::size_t>()];
  const json list = sparse["sparse"];
  sparse.erase("sparse");
  EXPECT_EQ(values(points["attributes"]["POSITION"]), rest);
  sparse["bufferView"] = list["values"]["bufferView"];
  sparse["count"] = 1;
  EXPECT_EQ(values(points["attributes"]["POSITION"]), moved);
  sparse["bufferView"] = list["indices"]["bufferView"];
  sparse["componentType"] = list["indices"]["componentType"];
  sparse["type"] = "SCALAR";
  EXPECT_EQ(values(points["attributes"]["POSITION"]), std::vector<float>{1});
}

TEST(KeptRest, OfGltfInObjIsCounted) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["materials"][0]["emissiveFactor"] = {1, 0, 0};
  gltf.j["materials"][0]["emissiveTexture"] = {{"index", 0}};
  json& primitive = gltf.j["meshes"][0]["primitives"][0];
  primitive["targets"] = json::array({{{"POSITION", primitive["attributes"]["POSITION"]}}});
  gltf.j["skins"] = json::array({{{"joints", {0}}}});
  gltf.j["nodes"][0]["translation"] = {1, 0, 0};
  const int times = gltf.floats({0, 1}, "SCALAR", 1),
            moves = gltf.floats({0, 0, 0, 1, 1, 1}, "VEC3", 3);
  gltf.j["animations"] = json::array(
      {{{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
        {"samplers", {{{"input", times}, {"output", moves}}}}}});
  const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.obj", kRest);
  EXPECT_EQ(written.uv_set, "vt");
  EXPECT_EQ(written.not_kept,
            (Lines{"1 x animations", "1 x meshes with morph targets, kept at rest",
                   "1 x nodes with transforms or children, applied to what they show",
                   "1 x primitives with uvs of their own", "1 x skins, kept at rest",
                   "2 x textures of materials"}));
}

// Positions of the file would be written in their place.
TEST(KeptRest, OtherPositionsThanWereReadAreRefused) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}});
  const path input = folder.write("s.glb", gltf.glb());
  const std::function<void(Scene&)> changes[] = {
      [](Scene& s) { s.positions[1].x += 1e-6f; },
      [](Scene& s) { std::swap(s.positions[0], s.positions[1]); },
      [](Scene& s) { s.positions.push_back({}); },
      [](Scene& s) { s.origin.y = 7; },
  };
  for (const auto& change : changes) {
    auto loaded = read_scene(input, {.keep_scene = true}, {});
    ASSERT_TRUE(loaded.ok());
    change(loaded->scene);
    const World world = world_of(loaded->scene);
    const Result<WorldFile> refused = write_kept(world, folder / "w.glb");
    EXPECT_EQ(refused.status().code(), ErrorCode::bad_input);
    EXPECT_NE(refused.status().message().find("set Scene::source to null"), std::string::npos);
    EXPECT_TRUE(write_kept(world, folder / "w.obj").ok());  // writes the scene's positions
    loaded->scene.source = nullptr;
    const Result<WorldFile> written = write_kept(world, folder / "w.glb");
    ASSERT_TRUE(written.ok()) << written.status().message();
    EXPECT_EQ(written->not_kept, Lines{"1 x cameras"});
    const auto back = read_scene(folder / "w.glb", {}, {});
    ASSERT_TRUE(back.ok());
    const auto second = [](const Scene& s) {
      const Vec3f p = s.positions[1];
      return std::pair(s.origin.x + double(p.x), s.origin.y + double(p.y));
    };
    EXPECT_EQ(second(back->scene), second(loaded->scene));
    std::filesystem::remove(folder / "w.glb");
  }
}

// A program that changes the triangles of a scene must remove its source.
TEST(KeptRest, OtherTrianglesThanWereReadAreRefused) {
  const TempFolder folder;
  const path input = folder.write("s.glb", textured(folder).glb());
  const std::function<void(Scene&)> changes[] = {
      [](Scene& s) {
        s.positions.insert(s.positions.end(), 3, {9, 9, 9});
        s.indices = {3, 4, 5};
      },
      [](Scene& s) {
        s.indices.insert(s.indices.end(), {0, 1, 2});
        s.texcoord_indices.insert(s.texcoord_indices.end(), {0, 1, 2});
        s.triangle_material.push_back(0);
        s.triangle_object.push_back(0);
      },
  };
  for (const auto& change : changes) {
    auto loaded = read_scene(input, kGltfRest, {});
    ASSERT_TRUE(loaded.ok());
    change(loaded->scene);
    const Result<WorldFile> written = write_kept(world_of(loaded->scene), folder / "w.glb");
    EXPECT_EQ(written.status().code(), ErrorCode::bad_input);
    EXPECT_NE(written.status().message().find("Scene::source"), std::string::npos);
    loaded->scene.source = nullptr;
    EXPECT_TRUE(write_kept(world_of(loaded->scene), folder / "w.glb").ok());
    std::filesystem::remove(folder / "w.glb");
  }
}

// Light of another file is written beside the colours that the vertices have.
TEST(KeptRest, LightOfAnotherFileIsWritten) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      gltf.floats({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3", 3);
  ReadOptions options = kGltfRest;
  options.illumination_file = folder.write("light.txt", "5 6 7\n8 9 10\n11 12 13\n");
  keep(folder.write("s.glb", gltf.glb()), folder / "w.glb", options);
  const auto triangles = GltfOracle(folder / "w.glb").triangles();
  EXPECT_EQ(triangles[0].attributes.at("_ILLUMINANCE"),
            (std::vector<double>{5, 6, 7, 8, 9, 10, 11, 12, 13}));
  EXPECT_EQ(triangles[0].attributes.at("COLOR_0")[3], 1);
}

}  // namespace
}  // namespace atlas::test
