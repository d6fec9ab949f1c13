#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/temp_folder.h"

namespace atlas {
namespace {

using nlohmann::json;
using test::TempFolder;

// A glTF file in the making: binary data with a view and an accessor for each array.
struct Gltf {
  json j = {{"asset", {{"version", "2.0"}}}};
  std::string bytes;

  template <class T>
  int view(const std::vector<T>& values, int stride = 0) {
    while (bytes.size() % 4 != 0) bytes += '\0';
    json v = {
        {"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride != 0) v["byteStride"] = stride;
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    j["bufferViews"].push_back(v);
    return int(j["bufferViews"].size()) - 1;
  }
  int accessor(json a) {
    j["accessors"].push_back(std::move(a));
    return int(j["accessors"].size()) - 1;
  }
  int floats(const std::vector<float>& values, const char* type, int components) {
    return accessor({{"bufferView", view(values)},
                     {"componentType", 5126},
                     {"type", type},
                     {"count", values.size() / components}});
  }
  template <class T>
  int indices(const std::vector<T>& values) {
    const int type = sizeof(T) == 1 ? 5121 : sizeof(T) == 2 ? 5123 : 5125;
    return accessor({{"bufferView", view(values)},
                     {"componentType", type},
                     {"type", "SCALAR"},
                     {"count", values.size()}});
  }
  // One mesh with one primitive, under one node.
  void single(json primitive, json node = json::object()) {
    j["meshes"] = json::array({{{"primitives", json::array({std::move(primitive)})}}});
    node["mesh"] = 0;
    j["nodes"] = json::array({std::move(node)});
    j["scenes"] = json::array({{{"nodes", {0}}}});
    j["scene"] = 0;
  }
  std::string glb() const {
    json with_buffer = j;
    std::string binary = bytes;
    binary.resize((binary.size() + 3) / 4 * 4);
    if (!bytes.empty()) with_buffer["buffers"] = json::array({{{"byteLength", bytes.size()}}});
    std::string text = with_buffer.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t v) {
      std::string s(4, '\0');
      const auto bits = std::uint32_t(v);
      std::memcpy(s.data(), &bits, 4);
      return s;
    };
    return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) + "JSON" +
           text + word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

Result<LoadedScene> load(const TempFolder& folder, const Gltf& gltf) {
  return read_scene(folder.write("scene.glb", gltf.glb()), {}, {});
}

const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

TEST(Gltf, TransformsColoursAndFlippedV) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, -2, 3}, "VEC2", 2);
  const int light = g.floats({1, 2, 3, 400, 5, 6, 7, 8, 9, -1, 0, 0}, "VEC3", 3);
  const int colours =
      g.floats({.1f, .1f, .1f, 1, .1f, .1f, .1f, 1, .1f, .1f, .1f, 1, 0, 0, 0, 1}, "VEC4", 4);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.single({{"attributes",
             {{"POSITION", positions},
              {"TEXCOORD_0", uvs},
              {"COLOR_0", colours},
              {"_ILLUMINANCE", light}}},
            {"indices", indices}});
  // A turn by 90 degrees about z, a scale, and a mirroring parent moved far away.
  g.j["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  g.j["nodes"][0]["scale"] = {2, 2, 2};
  g.j["nodes"].push_back({{"children", {0}}, {"scale", {-1, 1, 1}}, {"translation", {10, 20, 30}}});
  g.j["scenes"][0]["nodes"] = {1};
  const auto loaded = load(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.positions.size(), 4u);
  // (1, 0, 0) -> (0, 2, 0) -> (10, 22, 30); the file's own coordinates are origin + position.
  EXPECT_NEAR(s.origin.x + s.positions[1].x, 10, 1e-6);
  EXPECT_NEAR(s.origin.y + s.positions[1].y, 22, 1e-6);
  EXPECT_NEAR(s.origin.z + s.positions[1].z, 30, 1e-6);
  EXPECT_NEAR(s.origin.x + s.positions[3].x, 12, 1e-6);
  EXPECT_EQ(s.indices, (std::vector<std::uint32_t>{2, 1, 0, 3, 2, 0}));  // mirrored: turned round
  EXPECT_EQ(s.illumination[1], (Vec3f{400, 5, 6}));
  EXPECT_EQ(s.texcoords[0], (Vec2f{0, 1}));
  EXPECT_EQ(s.texcoords[3], (Vec2f{-2, -2}));
  EXPECT_EQ(loaded->defects.count(DefectKind::illumination_negative), 1u);
}

TEST(Gltf, NormalisedStridedAndSparseData) {
  const TempFolder folder;
  Gltf g;
  // Positions and 8-bit colours interleaved, 16 bytes a vertex.
  std::vector<float> packed;
  for (int i = 0; i < 4; ++i) {
    packed.insert(packed.end(), kSquare.begin() + 3 * i, kSquare.begin() + 3 * i + 3);
    const std::uint8_t rgba[4] = {std::uint8_t(51 * i), 255, 0, 9};
    float f;
    std::memcpy(&f, rgba, 4);
    packed.push_back(f);
  }
  const int view = g.view(packed, 16);
  const int at = g.view(std::vector<std::uint8_t>{2});
  const int moved = g.view(std::vector<float>{1, 1, 5});
  const int positions = g.accessor({{"bufferView", view},
                                    {"componentType", 5126},
                                    {"type", "VEC3"},
                                    {"count", 4},
                                    {"sparse",
                                     {{"count", 1},
                                      {"indices", {{"bufferView", at}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", moved}}}}}});
  const int colours = g.accessor({{"bufferView", view},
                                  {"byteOffset", 12},
                                  {"componentType", 5121},
                                  {"normalized", true},
                                  {"type", "VEC4"},
                                  {"count", 4}});
  g.single({{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}},
            {"indices", g.indices(std::vector<std::uint8_t>{0, 1, 2})}});
  const auto loaded = load(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.positions[2], (Vec3f{1, 1, 5}));
  EXPECT_EQ(loaded->scene.positions[1], (Vec3f{1, 0, 0}));
  EXPECT_EQ(loaded->scene.illumination[3], (Vec3f{0.6f, 1, 0}));
}

TEST(Gltf, StripsFansAndBareVertices) {
  const TempFolder folder;
  const auto indices_of = [&](int mode, bool indexed) {
    Gltf g;
    const int positions = g.floats({0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0}, "VEC3", 3);
    json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
    if (indexed) primitive["indices"] = g.indices(std::vector<std::uint32_t>{0, 2, 1, 3, 4});
    g.single(primitive);
    const auto loaded = load(folder, g);
    return loaded.ok() ? loaded->scene.indices : std::vector<std::uint32_t>{};
  };
  EXPECT_EQ(indices_of(5, false), (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 3, 4}));
  EXPECT_EQ(indices_of(5, true), (std::vector<std::uint32_t>{0, 2, 1, 1, 2, 3, 1, 3, 4}));
  EXPECT_EQ(indices_of(6, false), (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 3, 4}));
  EXPECT_EQ(indices_of(4, false), (std::vector<std::uint32_t>{0, 1, 2}));  // two left over
  EXPECT_TRUE(indices_of(1, false).empty());                               // lines
}

TEST(Gltf, EmbeddedAndExternalTextures) {
  const TempFolder folder;
  Image8 image(4, 2, 3, 10);
  image.at(0, 0)[0] = 200;  // bottom left
  ASSERT_TRUE(write_png(folder / "a b.png", image, {}).ok());
  const std::string png = TempFolder::read(folder / "a b.png");
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int view = g.view(std::vector<char>(png.begin(), png.end()));
  g.j["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}},
                   {{"uri", "a%20b.png"}},
                   {{"uri", "gone.png"}}};
  g.j["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 2}}};
  json primitives;
  for (int m = 0; m < 3; ++m) {
    json info = {{"index", m}};
    if (m == 1)
      info["extensions"]["KHR_texture_transform"] = {{"scale", {2, 4}}, {"offset", {0.5, 0.25}}};
    g.j["materials"].push_back(
        {{"pbrMetallicRoughness",
          {{"baseColorTexture", info}, {"baseColorFactor", {0.5, 0.25, 1, 1}}}}});
    primitives.push_back({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
                          {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
                          {"material", m}});
  }
  g.single(primitives[0]);
  g.j["meshes"][0]["primitives"] = primitives;
  const auto loaded = load(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.positions.size(), 4u);  // shared by the primitives
  ASSERT_EQ(s.textures.size(), 2u) << loaded->defects.lines().front();
  for (const Texture& t : s.textures) EXPECT_EQ(t.image.texels, image.texels);
  EXPECT_EQ(s.materials[2].texture, -1);
  EXPECT_EQ(s.materials[2].diffuse, (Vec3f{0.5f, 0.25f, 1}));
  EXPECT_EQ(loaded->defects.count(DefectKind::texture_missing), 1u);
  // glTF: (0, 0) -> (0.5, 0.25) with v down, which is (0.5, 0.75) with v up; (1, 1) -> (2.5,
  // -3.25).
  EXPECT_EQ(s.texcoords[s.texcoord_indices[3]], (Vec2f{0.5f, 0.75f}));
  EXPECT_EQ(s.texcoords[s.texcoord_indices[5]], (Vec2f{2.5f, -3.25f}));
}

// The same transform as numbers, as a matrix, and of a node above; a file without scenes shows all
// nodes that are nobody's children.
TEST(Gltf, MatricesAndScenesThatAreNotNamed) {
  const TempFolder folder;
  const auto positions_of = [&](const std::function<void(json&)>& arrange) {
    Gltf g;
    const int positions = g.floats(kSquare, "VEC3", 3);
    g.single({{"attributes", {{"POSITION", positions}}},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
    arrange(g.j);
    const auto loaded = load(folder, g);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.triangle_count(), 2u);
    return loaded->scene.positions;
  };
  const auto wanted = positions_of([](json& j) {
    j["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
    j["nodes"][0]["scale"] = {2, 3, 4};
    j["nodes"][0]["translation"] = {0.25, 0.5, 0.75};
  });
  const json matrix = {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 0.25, 0.5, 0.75, 1};
  const auto expect_same = [&](const std::vector<Vec3f>& got) {
    ASSERT_EQ(got.size(), wanted.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_NEAR(got[i].x, wanted[i].x, 1e-6);
      EXPECT_NEAR(got[i].y, wanted[i].y, 1e-6);
      EXPECT_NEAR(got[i].z, wanted[i].z, 1e-6);
    }
  };
  expect_same(positions_of([&](json& j) { j["nodes"][0]["matrix"] = matrix; }));
  expect_same(positions_of([&](json& j) {
    j["nodes"].push_back({{"children", {0}}, {"matrix", matrix}});
    j.erase("scenes");
    j.erase("scene");
  }));
}

// KHR_mesh_quantization: the most negative whole number is -1 as well.
TEST(Gltf, ShortPositionsAreFractions) {
  const TempFolder folder;
  for (const bool normalized : {false, true}) {
    Gltf g;
    const int view =
        g.view(std::vector<std::int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, -32768, -32767, 0, 0}, 8);
    const int positions = g.accessor({{"bufferView", view},
                                      {"componentType", 5122},
                                      {"normalized", normalized},
                                      {"type", "VEC3"},
                                      {"count", 3}});
    g.j["extensionsRequired"] = {"KHR_mesh_quantization"};
    g.single({{"attributes", {{"POSITION", positions}}}});
    const auto loaded = load(folder, g);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const auto& p = loaded->scene.positions;
    EXPECT_EQ(p[1], normalized ? (Vec3f{1, 0, 0}) : (Vec3f{32767, 0, 0}));
    EXPECT_EQ(p[2], normalized ? (Vec3f{-1, -1, 0}) : (Vec3f{-32768, -32767, 0}));
  }
}

// Two primitives: the first is lit and its texture coordinates are one short, the second has
// neither light nor trouble.
TEST(Gltf, WhatOnlySomePrimitivesHave) {
  const TempFolder folder;
  Gltf g;
  const int first = g.floats(kSquare, "VEC3", 3), second = g.floats(kSquare, "VEC3", 3);
  const int light = g.floats(kSquare, "VEC3", 3);
  const int three = g.floats({0, 0, 1, 0, 1, 1}, "VEC2", 2);
  const int four = g.floats({.5f, .5f, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.single({{"attributes", {{"POSITION", first}, {"COLOR_0", light}, {"TEXCOORD_0", three}}},
            {"indices", indices}});
  g.j["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", second}, {"TEXCOORD_0", four}}}, {"indices", indices}});
  const auto loaded = load(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.illumination.size(), 8u);
  EXPECT_EQ(s.illumination[2], (Vec3f{1, 1, 0}));
  EXPECT_EQ(s.illumination[6], Vec3f{});
  EXPECT_EQ(loaded->defects.count(DefectKind::illumination_missing), 4u);
  EXPECT_EQ(loaded->defects.count(DefectKind::texcoord_out_of_range), 1u);
  EXPECT_EQ(s.texcoord_indices[4], Scene::kNoTexcoord);
  EXPECT_EQ(s.texcoords[s.texcoord_indices[0]], (Vec2f{0, 1}));
  EXPECT_EQ(s.texcoords[s.texcoord_indices[9]], (Vec2f{.5f, .5f}));
}

TEST(Gltf, TexturesMayNameASetAndATurn) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 9), {}).ok());
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int zero = g.floats(std::vector<float>(8, 0), "VEC2", 2);
  const int one = g.floats({1, 1, 2, 1, 2, 2, 1, 2}, "VEC2", 2);
  const int two = g.floats({3, 1, 4, 1, 4, 2, 3, 2}, "VEC2", 2);
  const json attributes = {
      {"POSITION", positions}, {"TEXCOORD_0", zero}, {"TEXCOORD_1", one}, {"TEXCOORD_2", two}};
  g.j["images"] = {{{"uri", "a.png"}}};
  g.j["textures"] = {{{"source", 0}}};
  json primitives;
  for (int m = 0; m < 2; ++m) {
    json info = {{"index", 0}, {"texCoord", 1}};
    if (m == 1) info["extensions"]["KHR_texture_transform"] = {{"texCoord", 2}, {"rotation", 0.5}};
    g.j["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
    primitives.push_back({{"attributes", attributes},
                          {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})},
                          {"material", m}});
  }
  g.single(primitives[0]);
  g.j["meshes"][0]["primitives"] = primitives;
  const auto loaded = load(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.texcoords[s.texcoord_indices[1]], (Vec2f{2, 0}));
  EXPECT_EQ(s.texcoords[s.texcoord_indices[4]], (Vec2f{4, 0}));
  EXPECT_EQ(loaded->defects.count(DefectKind::texture_option_ignored), 1u);
}

json& sparse(json& j) {
  return j["accessors"][0]["sparse"];
}

TEST(Gltf, RangesAreChecked) {
  const TempFolder folder;
  struct Damage {
    const char* name;
    std::function<void(json&)> apply;
  };
  const std::vector<Damage> damages = {
      {"count", [](json& j) { j["accessors"][0]["count"] = 5; }},
      {"huge count", [](json& j) { j["accessors"][0]["count"] = 4000000000000ll; }},
      {"offset", [](json& j) { j["accessors"][0]["byteOffset"] = 4; }},
      {"view length", [](json& j) { j["bufferViews"][0]["byteLength"] = 4000; }},
      {"view offset", [](json& j) { j["bufferViews"][0]["byteOffset"] = 1ll << 40; }},
      {"stride", [](json& j) { j["bufferViews"][0]["byteStride"] = 252; }},
      {"buffer", [](json& j) { j["bufferViews"][0]["buffer"] = 3; }},
      {"view", [](json& j) { j["accessors"][0]["bufferView"] = 9; }},
      {"accessor", [](json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; }},
      {"type", [](json& j) { j["accessors"][0]["type"] = "SCALAR"; }},
      {"index type", [](json& j) { j["accessors"][1]["componentType"] = 5126; }},
      {"mesh", [](json& j) { j["nodes"][0]["mesh"] = 4; }},
      {"no data",
       [](json& j) {
         j["accessors"][0].erase("bufferView");
         j["accessors"][0]["count"] = 2000000000;
       }},
      {"image",
       [](json& j) {
         j["images"] = {{{"bufferView", 17}, {"mimeType", "image/png"}}};
       }},
      {"image range",
       [](json& j) {
         j["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 100000}, {"byteLength", 50}});
         j["images"] = {{{"bufferView", 3}, {"mimeType", "image/png"}}};
       }},
      {"sparse count", [](json& j) { sparse(j)["count"] = -1; }},
      {"sparse index", [](json& j) { sparse(j)["indices"]["byteOffset"] = 4; }},
      {"sparse indices", [](json& j) { sparse(j)["indices"]["bufferView"] = 9; }},
      {"sparse index type", [](json& j) { sparse(j)["indices"]["componentType"] = 7; }},
      {"sparse values", [](json& j) { sparse(j)["values"]["byteOffset"] = 44; }},
      {"colours",
       [](json& j) {
         j["accessors"].push_back(j["accessors"][0]);
         j["accessors"][2]["count"] = 3;
         j["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 2;
       }},
      {"no position",
       [](json& j) {
         j["meshes"][0]["primitives"][0]["attributes"] = {{"COLOR_0", 0}};
       }},
  };
  for (const Damage& damage : damages) {
    Gltf g;
    const int positions = g.floats(kSquare, "VEC3", 3);
    g.single({{"attributes", {{"POSITION", positions}}},
              {"indices", g.indices(std::vector<std::uint32_t>{0, 1, 2})}});
    const int at = g.view(std::vector<std::uint32_t>{1, 4});
    sparse(g.j) = {{"count", 1},
                   {"indices", {{"bufferView", at}, {"componentType", 5125}}},
                   {"values", {{"bufferView", 0}}}};
    ASSERT_TRUE(load(folder, g).ok());
    damage.apply(g.j);
    const auto loaded = load(folder, g);
    ASSERT_FALSE(loaded.ok()) << damage.name;
    EXPECT_NE(loaded.status().message().find("scene.glb"), std::string::npos) << damage.name;
  }
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  g.single(
      {{"attributes", {{"POSITION", positions}}},
       {"indices", g.indices(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 4, 0, 4000000000u, 3})}});
  const auto partly = load(folder, g);
  ASSERT_TRUE(partly.ok());
  EXPECT_EQ(partly->scene.triangle_count(), 1u);
  EXPECT_EQ(partly->defects.count(DefectKind::index_out_of_range), 2u);
}

TEST(Gltf, RandomDamageNeverCrashes) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  g.single({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}, {"COLOR_0", positions}}},
            {"indices", g.indices(std::vector<std::uint8_t>{0, 1, 2, 2, 3, 0})}});
  const std::string good = g.glb();
  std::mt19937 random(9);
  int survived = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string bytes = good;
    if (round % 4 == 0) {
      bytes.resize(random() % bytes.size());
    } else {
      for (int hits = 1 + int(random() % 3); hits > 0; --hits) {
        // Digits for digits keep the JSON valid and reach the range checks.
        char& c = bytes[random() % bytes.size()];
        c = c >= '0' && c <= '9' ? char('0' + random() % 10) : round % 4 == 1 ? char(random()) : c;
      }
    }
    const auto loaded = read_scene(folder.write("d.glb", bytes), {}, {});
    if (!loaded.ok()) continue;
    ++survived;
    for (const std::uint32_t i : loaded->scene.indices) {
      ASSERT_LT(i, loaded->scene.positions.size());
    }
  }
  EXPECT_GT(survived, 100);
}

}  // namespace
}  // namespace atlas
