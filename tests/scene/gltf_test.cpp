#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Gltf;
using test::json;
using test::kSquare;
using test::load_glb;
using test::TempFolder;

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
  // A rotation by 90 degrees about z, a scale, and a mirroring parent that is moved far away.
  g.j["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  g.j["nodes"][0]["scale"] = {2, 2, 2};
  g.j["nodes"].push_back({{"children", {0}}, {"scale", {-1, 1, 1}}, {"translation", {10, 20, 30}}});
  g.j["scenes"][0]["nodes"] = {1};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.positions.size(), 4u);
  // (1, 0, 0) -> (0, 2, 0) -> (10, 22, 30); the file's own coordinates are origin + position.
  EXPECT_NEAR(s.origin.x + s.positions[1].x, 10, 1e-6);
  EXPECT_NEAR(s.origin.y + s.positions[1].y, 22, 1e-6);
  EXPECT_NEAR(s.origin.z + s.positions[1].z, 30, 1e-6);
  EXPECT_NEAR(s.origin.x + s.positions[3].x, 12, 1e-6);
  // Mirrored, so the order is reversed.
  EXPECT_EQ(s.indices, (std::vector<std::uint32_t>{2, 1, 0, 3, 2, 0}));
  EXPECT_EQ(s.illumination[1], (Vec3f{400, 5, 6}));
  EXPECT_EQ(s.texcoords[0], (Vec2f{0, 1}));
  EXPECT_EQ(s.texcoords[3], (Vec2f{-2, -2}));
  EXPECT_EQ(loaded->defects.count(DefectKind::illumination_negative), 1u);
}

TEST(Gltf, NormalisedStridedAndSparseData) {
  const TempFolder folder;
  Gltf g;
  // Positions and 8-bit colours are interleaved, 16 bytes per vertex.
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
  const auto loaded = load_glb(folder, g);
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
    const auto loaded = load_glb(folder, g);
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
  const auto loaded = load_glb(folder, g);
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

json& sparse(json& j) {
  return j["accessors"][0]["sparse"];
}

// Ways to damage a file of one primitive, whose first accessor is sparse.
struct Damage {
  const char* name;
  std::function<void(json&)> apply;
};
const std::vector<Damage> kDamages = {
    {"count", [](json& j) { j["accessors"][0]["count"] = 5; }},
    {"huge count", [](json& j) { j["accessors"][0]["count"] = 4000000000000ll; }},
    {"offset", [](json& j) { j["accessors"][0]["byteOffset"] = 4; }},
    {"view length", [](json& j) { j["bufferViews"][0]["byteLength"] = 4000; }},
    {"view end", [](json& j) { j["bufferViews"][0]["byteOffset"] = 60; }},
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

TEST(Gltf, RangesAreChecked) {
  const TempFolder folder;
  for (const Damage& damage : kDamages) {
    Gltf g;
    const int positions = g.floats(kSquare, "VEC3", 3);
    g.single({{"attributes", {{"POSITION", positions}}},
              {"indices", g.indices(std::vector<std::uint32_t>{0, 1, 2})}});
    const int at = g.view(std::vector<std::uint32_t>{1, 4});
    sparse(g.j) = {{"count", 1},
                   {"indices", {{"bufferView", at}, {"componentType", 5125}}},
                   {"values", {{"bufferView", 0}}}};
    ASSERT_TRUE(load_glb(folder, g).ok());
    damage.apply(g.j);
    const auto loaded = load_glb(folder, g);
    ASSERT_FALSE(loaded.ok()) << damage.name;
    EXPECT_NE(loaded.status().message().find("scene.glb"), std::string::npos) << damage.name;
  }
}

TEST(Gltf, TrianglesBeyondTheVerticesAreLeftOut) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  g.single(
      {{"attributes", {{"POSITION", positions}}},
       {"indices", g.indices(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 4, 0, 4000000000u, 3})}});
  const auto partly = load_glb(folder, g);
  ASSERT_TRUE(partly.ok());
  EXPECT_EQ(partly->scene.triangle_count(), 1u);
  EXPECT_EQ(partly->defects.count(DefectKind::index_out_of_range), 2u);
}

TEST(Gltf, AMessageQuotesNoMegabytesOfData) {
  const TempFolder folder;
  const json file = {
      {"asset", {{"version", "2.0"}}},
      {"buffers",
       {{{"byteLength", 5},
         {"uri", "data:application/gltf-buffer;base64," + std::string(1 << 20, 'A')}}}}};
  const auto loaded = read_scene(folder.write("long.gltf", file.dump()), {}, {});
  ASSERT_FALSE(loaded.ok());
  const std::string& message = loaded.status().message();
  EXPECT_NE(message.find("long.gltf: "), std::string::npos) << message;
  EXPECT_LT(message.size(), 400u);
}

// The parser of JSON says what is UTF-8: strings that it takes stay, others become such strings.
TEST(Gltf, BytesOfNamesThatAreNotUtf8AreReplaced) {
  const TempFolder folder;
  Gltf g;
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})}},
           {{"name", "########"}});
  const std::string plain = g.glb();
  const std::size_t at = plain.find("########");
  const unsigned char kBytes[] = {'a',  0x7f, 0x80, 0x8f, 0x90, 0x9f, 0xa0, 0xbf, 0xc0, 0xc1, 0xc2,
                                  0xdf, 0xe0, 0xe1, 0xec, 0xed, 0xee, 0xef, 0xf0, 0xf1, 0xf4, 0xf5};
  std::mt19937 random(7);
  int kept = 0, replaced = 0;
  for (int round = 0; round < 6000; ++round) {
    std::string name(8, 'a'), bytes = plain;
    const std::size_t length = 1 + random() % 4;
    for (std::size_t i = 0; i < length; ++i) {
      const bool follows = i > 0 && random() % 8 != 0;  // else hardly any would be right
      name[2 + i] = char(kBytes[follows ? 2 + random() % 6 : random() % 22]);
    }
    bytes.replace(at, 8, name);
    const auto loaded = read_scene(folder.write("a.glb", bytes), {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const std::string got = loaded->scene.object_names[0];
    const std::uint64_t count = loaded->defects.count(DefectKind::text_not_utf8);
    if (json::accept('"' + name + '"')) {
      ASSERT_EQ(got, name);
      ASSERT_EQ(count, 0u);
      ++kept;
      continue;
    }
    ASSERT_TRUE(json::accept('"' + got + '"'));
    ASSERT_EQ(std::uint64_t(std::count(got.begin(), got.end(), '?')), count);
    ASSERT_GT(count, 0u);
    for (std::size_t i = 0; i < 8; ++i) ASSERT_TRUE(got[i] == name[i] || got[i] == '?');
    ++replaced;
  }
  EXPECT_GT(kept, 500);
  EXPECT_GT(replaced, 500);
}

TEST(Gltf, BytesThatAreNotUtf8AreNamed) {
  const TempFolder folder;
  const std::string begin = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"name":"M)";
  const std::string file =
      begin + "\xfc" +
      R"(ller"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"a.bin"}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}]})";
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  folder.write("a.bin", std::string(reinterpret_cast<const char*>(corners), 36));
  const auto loaded = read_scene(folder.write("a.gltf", file), {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.object_names[0], "M?ller");
  const std::string line = loaded->defects.lines().at(0);
  EXPECT_NE(line.find(fmt::format("a.gltf: byte {}", begin.size())), std::string::npos) << line;
  // Outside of a string, such a byte is an error as before.
  const auto outside = read_scene(folder.write("b.gltf", "{\n\xfc\"asset\":{}}"), {}, {});
  EXPECT_NE(outside.status().message().find("b.gltf:2: not valid JSON"), std::string::npos)
      << outside.status().message();
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
        // Replacing digits with digits keeps the JSON valid, so that the range checks are reached.
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

TEST(Gltf, MaterialsSayWhatIsSeenThroughThem) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int corners = g.indices(std::vector<std::uint16_t>{0, 1, 2});
  g.j["materials"] = {
      {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}, {"doubleSided", true}},
      {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 0.5}}}}},
      {{"alphaMode", "?"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, -3}}}}}};
  json primitives;
  for (int m = 0; m < 3; ++m)
    primitives.push_back(
        {{"attributes", {{"POSITION", positions}}}, {"indices", corners}, {"material", m}});
  g.single({});
  g.j["meshes"][0]["primitives"] = primitives;
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const std::vector<Material>& m = loaded->scene.materials;
  ASSERT_EQ(m.size(), 3u);
  EXPECT_TRUE(m[0].alpha_mode == AlphaMode::mask && m[0].double_sided);
  EXPECT_EQ(m[0].alpha_cutoff, 0.25f);
  EXPECT_TRUE(m[1].alpha_mode == AlphaMode::blend && !m[1].double_sided);
  EXPECT_EQ(m[1].opacity, 0.5f);
  EXPECT_TRUE(m[2].alpha_mode == AlphaMode::opaque);
  EXPECT_EQ(m[2].opacity, 0);
}

}  // namespace
}  // namespace atlas
