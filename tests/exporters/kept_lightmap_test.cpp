// Tests what becomes of the lightmap of an earlier export in a glTF file that is written again.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using Lines = std::vector<std::string>;

// A lightmap of an earlier export stays unless its uvs are replaced, whichever program has written
// the file since. Where it stays, its images must lie beside the new file.
TEST(KeptLightmap, StaysWithItsUvs) {
  const json images = {"a.png", "b%20c.png", "gone.png"};
  const struct {
    const char* generator;
    json map;
    bool stays;
  } cases[] = {{"libatlas", {{"images", images}, {"texCoord", 0}}, true},
               {"other", {{"images", images}, {"texCoord", 0}}, true},
               {"libatlas", {{"images", images}, {"texCoord", 1}}, false},
               {"other", {{"images", images}, {"texCoord", 1}}, false},
               {"libatlas", {{"images", images}, {"texCoord", "0"}}, false},
               {"other", {{"images", images}, {"texCoord", "0"}}, true},
               {"libatlas", {{"images", images}, {"texCoord", nullptr}}, false},
               {"libatlas", "text", false},
               {"other", "text", true}};
  for (const auto& c : cases) {
    const TempFolder folder;
    Gltf gltf = textured(folder);
    gltf.j["asset"]["generator"] = c.generator;
    gltf.j["asset"]["extras"]["lightmap"] = c.map;
    gltf.j["meshes"][0]["primitives"][0]["extras"]["lightmap"] = 3;
    const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    for (const char* there : {"a.png", "b c.png"}) folder.write(there, "");
    World world = world_of(loaded->scene);
    world.uv_set = 1;
    const Result<WorldFile> written = write_kept(world, folder / "w.glb");
    ASSERT_TRUE(written.ok()) << written.status().message();
    Lines lines;
    if (c.stays && c.map.is_object())
      lines.push_back(
          "1 x images of the lightmap, which are not beside the file (copy them there)");
    EXPECT_EQ(written->not_kept, lines) << c.map;
    const json after = GltfOracle(folder / "w.glb").document;
    const json extras = after["asset"]["extras"];
    EXPECT_EQ(extras.contains("lightmap"), c.stays) << c.map;
    if (c.stays) {
      EXPECT_EQ(extras["lightmap"], c.map);
    }

    // The page of an earlier one would be taken for one of the world's own.
    world.lightmap = Lightmap{{"a.png"}, {}, 1, {}};
    ASSERT_TRUE(write_kept(world, folder / "w.glb").ok());
    const json own = GltfOracle(folder / "w.glb").document;
    EXPECT_EQ(own["asset"]["extras"]["lightmap"]["images"], json({"a.png"}));
    EXPECT_FALSE(own["meshes"][0]["primitives"][0].contains("extras")) << c.map;
  }
}

// A primitive that lacks the lightmap's set gets the new uvs there, too. They are no place on it.
TEST(KeptLightmap, HasNoPlaceForNewUvs) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, std::uint8_t(9)), {}).ok());
  for (const bool any : {true, false}) {  // whether any primitive is on the lightmap
    Gltf gltf = textured(folder);
    gltf.j["asset"]["extras"]["lightmap"] = {{"images", {"a.png"}}, {"texCoord", 1}};
    json& primitives = gltf.j["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives[1]["extras"] = "mine";
    if (any) primitives[0]["attributes"]["TEXCOORD_1"] = primitives[0]["attributes"]["TEXCOORD_0"];
    const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    World world = world_of(loaded->scene);
    world.uv_set = 2;
    ASSERT_TRUE(write_kept(world, folder / "w.glb").ok());
    const json after = GltfOracle(folder / "w.glb").document["meshes"][0]["primitives"];
    EXPECT_FALSE(after[0].contains("extras"));
    EXPECT_TRUE(after[1]["attributes"].contains("TEXCOORD_1"));
    const json page = {{"source", "mine"}, {"lightmap", -1}};
    EXPECT_EQ(after[1]["extras"], any ? page : json("mine"));
    const auto back = read_scene(folder / "w.glb", {.lightmap = true}, {});
    ASSERT_TRUE(back.ok()) << back.status().message();
    EXPECT_EQ(back->scene.lightmap != nullptr, any);
    if (!any) continue;
    const auto& uvs = back->scene.lightmap->texcoord_indices;
    ASSERT_EQ(uvs.size(), 6u);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(uvs[k] == Scene::kNoTexcoord, k >= 3) << k;
  }
}

}  // namespace
}  // namespace atlas::test
