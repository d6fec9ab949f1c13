// Tests a World::scene that was read from glTF: which set of texture coordinates the new uvs take.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

TEST(KeptUvSets, TheNewUvsTakeTheFirstFreeSet) {
  const struct {
    std::vector<int> sets;
    const char* expected;
  } cases[] = {{{}, "TEXCOORD_1"},
               {{0}, "TEXCOORD_1"},
               {{0, 1}, "TEXCOORD_2"},
               {{7}, "TEXCOORD_1"},
               {{0, 1, 2, 4}, "TEXCOORD_3"}};
  for (const auto& c : cases) {
    const TempFolder folder;
    Gltf gltf;
    json attributes = {{"POSITION", gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}};
    for (const int set : c.sets)
      attributes["TEXCOORD_" + std::to_string(set)] =
          gltf.floats({0, 0, 1, 0, 0, float(set)}, "VEC2", 2);
    gltf.single({{"attributes", attributes}});
    const std::filesystem::path input = folder.write("s.glb", gltf.glb());
    EXPECT_EQ(keep(input, folder / "w.glb").uv_set, c.expected);
    const auto triangles = GltfOracle(folder / "w.glb").triangles();
    ASSERT_EQ(triangles.size(), 1u);
    const auto& after = triangles[0].attributes;
    for (const int set : c.sets) EXPECT_EQ(after.at("TEXCOORD_" + std::to_string(set))[5], set);
    EXPECT_EQ(after.at(c.expected)[2], 1.0 / 64);
    EXPECT_TRUE(after.contains("TEXCOORD_0"));
  }
}

// Writes TEXCOORD_`set` in place of what a triangle with these sets has, and checks both. Every set
// holds its own number.
void expect_replaced(const std::vector<int>& sets, int set) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  json& primitive = gltf.j["meshes"][0]["primitives"][0];
  for (const int own : sets)
    primitive["attributes"]["TEXCOORD_" + std::to_string(own)] =
        gltf.floats({0, 0, 1, 0, 0, float(own)}, "VEC2", 2);
  gltf.j["materials"][0]["occlusionTexture"] = {{"index", 0}, {"texCoord", sets.back()}};
  const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  World world = world_of(loaded->scene);
  world.uv_set = set;
  const auto written = write_kept(world, folder / "w.glb");
  ASSERT_TRUE(written.ok()) << written.status().message();
  EXPECT_EQ(written->uv_set, "TEXCOORD_" + std::to_string(set));
  EXPECT_TRUE(written->not_kept.empty());
  const auto triangles = GltfOracle(folder / "w.glb").triangles();
  ASSERT_EQ(triangles.size(), 1u);
  const auto& after = triangles[0].attributes;
  for (const int own : sets) {
    if (own != set) {
      EXPECT_EQ(after.at("TEXCOORD_" + std::to_string(own))[5], own);
    }
  }
  EXPECT_EQ(after.at(written->uv_set)[2], 1.0 / 64);
  EXPECT_FALSE(after.contains("TEXCOORD_" + std::to_string(std::max(set, sets.back()) + 1)));
}

TEST(KeptUvSets, TheNewUvsReplaceTheSetThatIsAskedFor) {
  expect_replaced({0, 1}, 1);
  expect_replaced({0, 1, 2}, 1);
  expect_replaced({0, 1, 2}, 2);
  expect_replaced({0, 1}, 3);
}

}  // namespace
}  // namespace atlas::test
