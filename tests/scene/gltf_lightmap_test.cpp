// Lightmaps that glTF files name in asset.extras.lightmap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "libatlas/core/srgb.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/check_scene.h"
#include "tests/scene/load_scene.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

// Two squares, each a primitive, on page 0 and 1 of a lightmap whose images are beside the file.
class GltfLightmaps : public ::testing::Test {
 protected:
  GltfLightmaps() {
    for (const int page : {0, 1}) {
      const std::string name = "lit_" + std::to_string(page);
      EXPECT_TRUE(write_png(folder_ / (name + ".png"), Image8(4, 2, 3, code(page)), {}).ok());
      EXPECT_TRUE(write_exr(folder_ / (name + ".exr"), ImageF(4, 2, 3, linear(page))).ok());
    }
    gltf_.single(square(0));
    primitives().push_back(square(1));
    map_ = {{"images", {"lit_0.png", "lit_1.png"}},
            {"linear", {"lit_0.exr", "lit_1.exr"}},
            {"texCoord", 1},
            {"white", 100}};
  }
  static std::uint8_t code(int page) { return page == 0 ? 128 : 255; }
  static float linear(int page) { return page == 0 ? 20.0f : 500.0f; }

  json& primitives() { return gltf_.j["meshes"][0]["primitives"]; }
  json square(int page) {
    const int uvs = gltf_.floats({0, 0, 1, 0, 1, 1, 0, 0.75f}, "VEC2", 2);
    return {{"attributes",
             {{"POSITION", gltf_.floats(kSquare, "VEC3", 3)},
              {"TEXCOORD_0", gltf_.floats({0, 0, 0, 0, 0, 0, 0, 0}, "VEC2", 2)},
              {"TEXCOORD_1", uvs}}},
            {"indices", gltf_.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})},
            {"extras", {{"lightmap", page}}}};
  }
  LoadedScene loaded(bool asked = true) {
    gltf_.j["asset"]["extras"]["lightmap"] = map_;
    ReadOptions options;
    options.lightmap = asked;
    LoadedScene scene = load(folder_.write("lit.glb", gltf_.glb()), options);
    EXPECT_EQ(check_scene(scene.scene).message(), "");
    return scene;
  }
  static std::string names(const std::vector<fs::path>& files) {
    std::string all;
    for (const fs::path& file : files) all += file.filename().string() + ";";
    return all;
  }
  // Returns the first value of each page; -1 for pages that are empty.
  static std::vector<float> values(const Scene& scene) {
    std::vector<float> all;
    if (!scene.lightmap) return all;
    for (const ImageF& page : scene.lightmap->pages)
      all.push_back(page.empty() ? -1 : page.texels[0]);
    return all;
  }

  TempFolder folder_;
  Gltf gltf_;
  json map_;
};

TEST_F(GltfLightmaps, LinearImagesAreRead) {
  const LoadedScene read = loaded();
  EXPECT_TRUE(read.defects.empty()) << read.defects.lines()[0];
  ASSERT_TRUE(read.scene.lightmap);
  const SceneLightmap& map = *read.scene.lightmap;
  EXPECT_EQ(values(read.scene), (std::vector<float>{20, 500}));
  EXPECT_EQ(map.pages[1].width, 4);
  EXPECT_EQ(map.triangle_page, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  const Vec2f last = map.texcoords[map.texcoord_indices[11]];
  EXPECT_EQ(last, (Vec2f{0, 0.25f})) << "v points up";
  EXPECT_EQ(names(read.files), "lit_0.exr;lit_1.exr;");
  EXPECT_EQ(names(read.unread_files), "lit_0.png;lit_1.png;");
}

TEST_F(GltfLightmaps, AreNotReadUnlessAskedFor) {
  const LoadedScene read = loaded(false);
  EXPECT_FALSE(read.scene.lightmap);
  EXPECT_TRUE(read.files.empty());
  EXPECT_EQ(names(read.unread_files), "lit_0.png;lit_1.png;lit_0.exr;lit_1.exr;");
  EXPECT_TRUE(read.defects.empty());
}

// sRGB 128 is 0.2158 of the light that is white. After a tone curve the unit is not known.
TEST_F(GltfLightmaps, OtherwiseTheImagesTimesWhite) {
  map_.erase("linear");
  LoadedScene read = loaded();
  EXPECT_TRUE(read.defects.empty());
  EXPECT_EQ(values(read.scene), (std::vector<float>{100 * srgb_decode8(128), 100}));
  EXPECT_EQ(read.scene.lightmap->white, 100);
  map_.erase("white");
  read = loaded();
  EXPECT_EQ(values(read.scene), (std::vector<float>{srgb_decode8(128), 1}));
  EXPECT_EQ(read.scene.lightmap->white, 0);
}

TEST_F(GltfLightmaps, AMissingLinearImageIsToldAndTheOthersAreUsed) {
  map_["linear"][1] = "gone.exr";
  const LoadedScene read = loaded();
  EXPECT_EQ(read.defects.count(DefectKind::lightmap_clipped), 1u);
  EXPECT_NE(read.defects.lines()[0].find("gone.exr: there is no such file"), std::string::npos);
  EXPECT_EQ(values(read.scene), (std::vector<float>{100 * srgb_decode8(128), 100}));
}

TEST_F(GltfLightmaps, OnlyPagesThatAreUsedAreRead) {
  primitives().erase(0);
  map_["linear"][0] = "gone.exr";
  const LoadedScene read = loaded();
  EXPECT_TRUE(read.defects.empty());
  EXPECT_EQ(values(read.scene), (std::vector<float>{-1, 500}));
  EXPECT_EQ(names(read.files), "lit_1.exr;");
}

TEST_F(GltfLightmaps, APrimitiveThatSaysNoPageIsOnTheFirst) {
  for (json& primitive : primitives()) primitive.erase("extras");
  const LoadedScene read = loaded();
  EXPECT_EQ(read.scene.lightmap->triangle_page, (std::vector<std::uint32_t>(4, 0)));
}

// Names are encoded as other uris are, or plain.
TEST_F(GltfLightmaps, NamesAreUris) {
  fs::create_directory(folder_ / "a b");
  fs::rename(folder_ / "lit_0.exr", folder_ / "a b/100% c.exr");
  for (const char* name : {"a%20b/100%25%20c.exr", "a b/100% c.exr"}) {
    map_["linear"][0] = name;
    EXPECT_EQ(values(loaded().scene), (std::vector<float>{20, 500})) << name;
  }
  map_["linear"][0] = (folder_ / "a b/100% c.exr").string();
  EXPECT_EQ(values(loaded().scene), (std::vector<float>{20, 500})) << "absolute";
}

TEST_F(GltfLightmaps, EachPlaceOfAMeshHasThem) {
  gltf_.j["nodes"].push_back({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  gltf_.j["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = loaded().scene;
  ASSERT_EQ(scene.triangle_count(), 8u);
  const SceneLightmap& map = *scene.lightmap;
  EXPECT_EQ(map.triangle_page, (std::vector<std::uint32_t>{0, 0, 1, 1, 0, 0, 1, 1}));
  // The second one is mirrored, so that its corners come in the opposite order.
  EXPECT_EQ(map.texcoord_indices[0], map.texcoord_indices[14]);
  EXPECT_EQ(map.texcoord_indices[2], map.texcoord_indices[12]);
}

TEST_F(GltfLightmaps, TrianglesThatAreLeftOutTakeTheirPlaceAlong) {
  primitives()[0]["indices"] = gltf_.indices(std::vector<std::uint16_t>{0, 1, 9, 0, 2, 3});
  const Scene scene = loaded().scene;
  ASSERT_EQ(scene.triangle_count(), 3u);
  EXPECT_EQ(scene.lightmap->triangle_page, (std::vector<std::uint32_t>{0, 1, 1}));
  const SceneLightmap& map = *scene.lightmap;
  EXPECT_EQ(map.texcoords[map.texcoord_indices[2]], (Vec2f{0, 0.25f}));
}

// Vertices on the lightmap need no light of their own.
TEST_F(GltfLightmaps, PrimitivesWithoutAPlaceAreTold) {
  primitives()[0]["attributes"].erase("TEXCOORD_1");
  primitives()[0]["attributes"]["_ILLUMINANCE"] =
      gltf_.floats(std::vector<float>(12, 3), "VEC3", 3);
  const LoadedScene read = loaded();
  EXPECT_EQ(read.defects.count(DefectKind::lightmap_absent), 1u);
  EXPECT_EQ(read.defects.count(DefectKind::illumination_missing), 0u);
  EXPECT_NE(read.defects.lines()[0].find("primitive 0: has no TEXCOORD_1"), std::string::npos)
      << read.defects.lines()[0];
  EXPECT_EQ(read.scene.lightmap->texcoord_indices[5], Scene::kNoTexcoord);
  EXPECT_EQ(read.scene.illumination[0], (Vec3f{3, 3, 3}));
  EXPECT_EQ(read.scene.illumination[4], (Vec3f{0, 0, 0}));
}

TEST_F(GltfLightmaps, UnlitMaterialsNeedNone) {
  gltf_.j["materials"] = json::array({{{"extensions", {{"KHR_materials_unlit", json::object()}}}}});
  primitives()[0]["material"] = 0;
  primitives()[0]["attributes"].erase("TEXCOORD_1");
  const LoadedScene read = loaded();
  EXPECT_TRUE(read.defects.empty());
  EXPECT_EQ(values(read.scene), (std::vector<float>{-1, 500}));
}

TEST_F(GltfLightmaps, ValuesThatAreNoLightAreReplaced) {
  ImageF page(3, 1, 3, 7);
  page.texels[0] = std::nanf("");
  page.texels[4] = INFINITY;
  page.texels[8] = -2;
  ASSERT_TRUE(write_exr(folder_ / "lit_0.exr", page).ok());
  const LoadedScene read = loaded();
  EXPECT_EQ(read.defects.count(DefectKind::illumination_not_finite), 2u);
  const std::vector<float>& texels = read.scene.lightmap->pages[0].texels;
  EXPECT_EQ(texels, (std::vector<float>{0, 7, 7, 7, 0, 7, 7, 7, -2}));
}

TEST_F(GltfLightmaps, GreyImagesAndAlphaAreUnderstood) {
  ASSERT_TRUE(write_exr(folder_ / "lit_0.exr", ImageF(2, 2, 1, 9)).ok());
  ASSERT_TRUE(write_exr(folder_ / "lit_1.exr", ImageF(2, 2, 4, 1)).ok());
  EXPECT_EQ(loaded().scene.lightmap->pages[0].texels, (std::vector<float>(12, 9)));
  EXPECT_EQ(loaded().scene.lightmap->pages[1].texels, (std::vector<float>(12, 1)));
  map_.erase("linear");
  ASSERT_TRUE(write_png(folder_ / "lit_0.png", Image8(2, 2, 2, 255), {}).ok());
  ASSERT_TRUE(write_png(folder_ / "lit_1.png", Image8(2, 2, 4, 255), {}).ok());
  EXPECT_EQ(loaded().scene.lightmap->pages[0].texels, (std::vector<float>(12, 100)));
  EXPECT_EQ(loaded().scene.lightmap->pages[1].texels, (std::vector<float>(12, 100)));
}

// Each spoils the whole lightmap. The scene is then read as one without.
TEST_F(GltfLightmaps, HostileOnesAreLeftOut) {
  folder_.write("no_image.exr", "text");
  const json good = map_;
  const json both = json::array({"lit_0.exr", "lit_1.exr"});
  const struct {
    const char* says;
    json changed;
  } cases[] = {
      {"is no object", 5},
      {"is no object", json::array({1})},
      {"names no images", {{"images", nullptr}, {"linear", nullptr}}},
      {"names no images", {{"images", 7}, {"linear", "lit_0.exr"}}},
      {"names no image for page 0", {{"images", {1, 2}}, {"linear", {json::object(), nullptr}}}},
      {"names no image for page 0", {{"images", {"", ""}}, {"linear", json::array()}}},
      {"no such file", {{"images", {"../gone.png", "/gone/x.png"}}, {"linear", json::array()}}},
      {"no such file", {{"images", {".", "."}}, {"linear", json::array()}}},
      {"no image for page 0",
       {{"images", {nullptr, "lit_0.png", "lit_1.png"}}, {"linear", nullptr}}},
      {"no image for page 0", {{"images", {json::object(), "lit_0.png"}}, {"linear", nullptr}}},
      {"names no image for page 1", {{"images", {"lit_0.png"}}, {"linear", {"lit_0.exr", "a"}}}},
      {"no_image.exr", {{"images", json::array()}, {"linear", {"no_image.exr", "lit_1.exr"}}}},
      {"texCoord", {{"texCoord", "1"}}},
      {"texCoord", {{"texCoord", 1.5}}},
      {"texCoord", {{"texCoord", -1}}},
      {"texCoord", {{"texCoord", nullptr}}},
      {"texCoord", {{"texCoord", 4294967297}}},
      {"texCoord", {{"texCoord", 18446744073709551615u}}},
      {"no triangle has TEXCOORD_7", {{"texCoord", 7}}},
      {"no triangle has", {{"texCoord", 2147483647}}},
      {"white", {{"white", 0}}},
      {"white", {{"white", nullptr}}},
      {"white", {{"white", json::array()}}},
      {"white", {{"white", -3}}},
      {"white", {{"white", "x"}}},
      {"white", {{"white", 1e300}}},
  };
  for (const auto& c : cases) {
    map_ = good;
    if (c.changed.is_object())
      map_.update(c.changed);
    else
      map_ = c.changed;
    const LoadedScene read = loaded();
    EXPECT_FALSE(read.scene.lightmap) << c.changed;
    ASSERT_EQ(read.defects.count(DefectKind::lightmap_unusable), 1u) << c.changed;
    EXPECT_EQ(read.defects.count(DefectKind::lightmap_absent), 0u) << c.changed;
    const std::string line = read.defects.lines()[0];
    EXPECT_NE(line.find(c.says), std::string::npos) << c.changed << ": " << line;
    EXPECT_EQ(read.scene.triangle_count(), 4u);
  }
}

// Each spoils one primitive.
TEST_F(GltfLightmaps, HostilePrimitivesAreWithoutLight) {
  const json good = primitives()[0];
  const int short_uvs = gltf_.floats({0, 0, 1, 0}, "VEC2", 2),
            no_uvs = gltf_.floats({0, 0, 0, 0}, "SCALAR", 1),
            huge = gltf_.accessor({{"componentType", 5126}, {"type", "VEC2"}, {"count", 16000000}}),
            no_view = gltf_.accessor(
                {{"bufferView", 999}, {"componentType", 5126}, {"type", "VEC2"}, {"count", 4}});
  const json cases[] = {{{"extras", {{"lightmap", 2}}}},
                        {{"extras", {{"lightmap", -1}}}},
                        {{"extras", {{"lightmap", 1.0}}}},
                        {{"extras", {{"lightmap", "0"}}}},
                        {{"extras", {{"lightmap", 2147483647}}}},
                        {{"extras", {{"lightmap", 4294967296}}}},
                        {{"extras", {{"lightmap", -4294967296}}}},
                        {{"extras", {{"lightmap", nullptr}}}},
                        {{"extras", {{"lightmap", json::object()}}}},
                        {{"attributes", {{"TEXCOORD_1", short_uvs}}}},
                        {{"attributes", {{"TEXCOORD_1", no_uvs}}}},
                        {{"attributes", {{"TEXCOORD_1", huge}}}},
                        {{"attributes", {{"TEXCOORD_1", no_view}}}},
                        {{"attributes", {{"TEXCOORD_1", 12345}}}}};
  for (const json& changed : cases) {
    primitives()[0] = good;
    primitives()[0].merge_patch(changed);
    if (changed.contains("extras")) primitives()[0]["extras"] = changed["extras"];
    const LoadedScene read = loaded();
    ASSERT_TRUE(read.scene.lightmap) << changed;
    EXPECT_EQ(read.defects.count(DefectKind::lightmap_absent), 1u) << changed;
    EXPECT_EQ(read.scene.lightmap->texcoord_indices[0], Scene::kNoTexcoord) << changed;
    EXPECT_EQ(values(read.scene), (std::vector<float>{-1, 500})) << changed;
  }
}

TEST_F(GltfLightmaps, CoordinatesThatAreNotFiniteAreReplaced) {
  primitives()[0]["attributes"]["TEXCOORD_1"] =
      gltf_.floats({0, 0, std::nanf(""), 0, 1, INFINITY, 0, 0}, "VEC2", 2);
  const LoadedScene read = loaded();
  EXPECT_EQ(read.defects.count(DefectKind::texcoord_not_finite), 2u);
  EXPECT_TRUE(read.scene.lightmap);
}

}  // namespace
}  // namespace atlas::test
