// How glTF files hold numbers: types, sparse parts, chunks and buffers.
#include <gtest/gtest.h>

#include <cmath>

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

// The sparse part of fractions has indices that are none.
TEST(GltfData, SparseFractions) {
  const TempFolder folder;
  Gltf g;
  const int at = g.view(std::vector<std::uint8_t>{1, 3});
  const int values = g.view(std::vector<std::uint8_t>{51, 0, 255, 102, 0, 0});
  const int colours = g.accessor({{"componentType", 5121},
                                  {"normalized", true},
                                  {"type", "VEC3"},
                                  {"count", 4},
                                  {"sparse",
                                   {{"count", 2},
                                    {"indices", {{"bufferView", at}, {"componentType", 5121}}},
                                    {"values", {{"bufferView", values}}}}}});
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}, {"COLOR_0", colours}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.illumination, (std::vector<Vec3f>{{}, {0.2f, 0, 1}, {}, {0.4f, 0, 0}}));
}

TEST(GltfData, WordsAndBytesAsFractions) {
  const TempFolder folder;
  const auto second = [&](int type, int view, Gltf& g) {
    const int positions = g.accessor({{"bufferView", view},
                                      {"componentType", type},
                                      {"normalized", true},
                                      {"type", "VEC3"},
                                      {"count", 3}});
    g.single({{"attributes", {{"POSITION", positions}}}});
    const auto loaded = load_glb(folder, g);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    return loaded.ok() ? loaded->scene.positions.at(1) : Vec3f{};
  };
  Gltf bytes, words;
  EXPECT_EQ(
      second(5120,
             bytes.view(std::vector<std::int8_t>{0, 0, 0, 0, 127, -127, -128, 0, 0, 127, 0, 0}, 4),
             bytes),
      (Vec3f{1, -1, -1}));
  EXPECT_EQ(
      second(
          5123,
          words.view(std::vector<std::uint16_t>{0, 0, 0, 0, 65535, 13107, 0, 0, 0, 65535, 0, 0}, 8),
          words),
      (Vec3f{1, 0.2f, 0}));
}

// The first buffer is in the text, and the second one in a file that is longer than it.
TEST(GltfData, BuffersInTheTextAndInFiles) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  g.single({{"attributes", {{"POSITION", positions}}}});
  g.j["bufferViews"][0]["buffer"] = 1;
  g.j["buffers"] = {{{"byteLength", 3}, {"uri", "data:application/gltf-buffer;base64,AAAA"}},
                    {{"byteLength", g.bytes.size()}, {"uri", "a.bin"}}};
  folder.write("a.bin", g.bytes + "more");
  const auto loaded = read_scene(folder.write("a.gltf", g.j.dump()), {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.positions[2], (Vec3f{0, 1, 0}));
  EXPECT_EQ(loaded->files, std::vector<std::filesystem::path>{folder / "a.bin"});
}

TEST(GltfData, ChunksStayInsideTheirFile) {
  const TempFolder folder;
  Gltf g;
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint32_t>{0, 1, 2})}});
  const std::string good = g.glb();
  const std::size_t chunk = good.size() - g.bytes.size() - 8;
  for (const int more : {1, 4, 8, 9}) {
    std::string bytes = good;
    bytes[chunk] = char(bytes[chunk] + more);
    const Status status = read_scene(folder.write("a.glb", bytes), {}, {}).status();
    EXPECT_NE(status.message().find("its binary chunk is longer than the file"), std::string::npos)
        << status.message();
  }
  // A chunk of another kind is padded to whole words.
  std::string before = good.substr(0, chunk) + std::string("\5\0\0\0KINDbytes\0\0\0", 16);
  std::string bytes = before + good.substr(chunk);
  const auto size = std::uint32_t(bytes.size());
  std::memcpy(&bytes[8], &size, 4);
  const auto loaded = read_scene(folder.write("a.glb", bytes), {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
}

// Sizes are those of what is shown: points and hidden nodes count nothing, vertices that primitives
// share count once, and each vertex of a strip but two ends a triangle.
TEST(GltfData, OnlyWhatIsShownCountsAgainstTheLimit) {
  const TempFolder folder;
  const auto zeros = [](Gltf& g, int count) {
    return g.accessor({{"componentType", 5126}, {"type", "VEC3"}, {"count", count}});
  };
  Gltf points;
  points.single({{"attributes", {{"POSITION", points.floats(kSquare, "VEC3", 3)}}}});
  for (int i = 0; i < 40; ++i)
    points.j["meshes"][0]["primitives"].push_back(
        {{"attributes", {{"POSITION", zeros(points, 1 << 24)}}}, {"mode", 0}});
  EXPECT_TRUE(load_glb(folder, points).ok());

  Gltf sharing;
  json primitive = {{"attributes", {{"POSITION", zeros(sharing, 300000)}}},
                    {"indices", sharing.indices(std::vector<std::uint16_t>{0, 1, 2})}};
  sharing.single(primitive);
  for (int i = 0; i < 2000; ++i) sharing.j["meshes"][0]["primitives"].push_back(primitive);
  EXPECT_TRUE(load_glb(folder, sharing).ok());

  json node;
  Gltf strips;
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      zeros(strips, 1 << 17);
  strips.single({{"attributes", {{"POSITION", zeros(strips, 1500)}}}, {"mode", 5}}, node);
  EXPECT_NE(load_glb(folder, strips).status().message().find("as often as it is shown"),
            std::string::npos);

  Gltf& hidden = strips;
  hidden.j["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
  hidden.j["nodes"].push_back({{"mesh", 0}});
  hidden.j["scenes"][0]["nodes"] = {0, 1};
  EXPECT_EQ(load_glb(folder, hidden).status().message(), "");
}

TEST(GltfData, DefectsAreNamedByTheirNumbers) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, NAN, 0, 0}, "VEC3", 3);
  g.single({{"attributes", {{"POSITION", positions}}},
            {"indices", g.indices(std::vector<std::uint8_t>{0, 1, 2, 0, 1, 3, 0, 1})}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
  EXPECT_EQ(loaded->defects.triangles_left_out, 2u);
  std::string places;
  for (const Defect& defect : loaded->defects.defects)
    places += defect.first_places[0].substr(defect.first_places[0].rfind("scene.glb") + 9) + ";";
  EXPECT_EQ(places, ": mesh 0 primitive 0: its end;: mesh 0 primitive 0 triangle 1;: vertex 3;");
}

}  // namespace
}  // namespace atlas
