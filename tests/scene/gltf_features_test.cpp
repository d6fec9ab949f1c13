// What glTF files say in more than one way, or only in part.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/gltf_maker.h"
#include "tests/scene/temp_folder.h"

namespace atlas {
namespace {

using test::Gltf;
using test::json;
using test::kSquare;
using test::load_glb;
using test::TempFolder;

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
    const auto loaded = load_glb(folder, g);
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
    const auto loaded = load_glb(folder, g);
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
  const auto loaded = load_glb(folder, g);
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
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  EXPECT_EQ(s.texcoords[s.texcoord_indices[1]], (Vec2f{2, 0}));
  EXPECT_EQ(s.texcoords[s.texcoord_indices[4]], (Vec2f{4, 0}));
  EXPECT_EQ(loaded->defects.count(DefectKind::texture_option_ignored), 1u);
}

}  // namespace
}  // namespace atlas
