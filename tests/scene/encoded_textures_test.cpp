// Textures that stay encoded, for exports that only pass them on.
#include <gtest/gtest.h>

#include <string>

#include "libatlas/image/image_io.h"
#include "libatlas/scene/check_scene.h"
#include "tests/scene/load_scene.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

std::string text_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

std::string png(const TempFolder& folder) {
  const auto path = folder / "made.png";
  EXPECT_TRUE(write_png(path, Image8(4, 2, 3, 77), {}).ok());
  return TempFolder::read(path);
}

TEST(EncodedTextures, BesideAnObj) {
  const TempFolder folder;
  const std::string bytes = png(folder);
  folder.write("broken.png", "\x89PNG no more");
  // Other image formats are decoded. A file that is no image is reported as without this option.
  folder.write("grey.pgm", "P5\n2 1\n255\n\x10\x20");
  folder.write("m.mtl",
               "newmtl a\nmap_Kd made.png\nnewmtl b\nmap_Kd grey.pgm\nnewmtl c\nmap_Kd broken.png\n"
               "newmtl d\nmap_Kd gone.png\n");
  const auto obj = folder.write(
      "s.obj",
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\n"
      "f 1/1 2/1 3/1\nusemtl c\nf 1/1 2/1 3/1\nusemtl d\nf 1/1 2/1 3/1\n");
  const LoadedScene loaded = load(obj, {.encoded_textures = true});
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(text_of(scene.textures[0].encoded), bytes);
  EXPECT_TRUE(scene.textures[0].image.empty());
  EXPECT_TRUE(scene.textures[1].encoded.empty());
  EXPECT_EQ(scene.textures[1].image.width, 2);
  EXPECT_EQ(loaded.defects.count(DefectKind::texture_missing), 1u);
  EXPECT_EQ(loaded.defects.count(DefectKind::texture_unreadable), 1u);
  EXPECT_TRUE(check_scene(scene).ok());
  EXPECT_NE(check_images(scene).message().find("textures[0]"), std::string::npos);
  EXPECT_TRUE(check_images(load(obj).scene).ok());
}

TEST(EncodedTextures, EmbeddedInAGlb) {
  const TempFolder folder;
  const std::string bytes = png(folder);
  Gltf gltf;
  const int view = gltf.view(std::vector<char>(bytes.begin(), bytes.end()));
  gltf.j["images"] = json::array({{{"bufferView", view}, {"mimeType", "image/png"}}});
  gltf.j["textures"] = json::array({{{"source", 0}}});
  const json surface = {{"baseColorTexture", {{"index", 0}}}};
  gltf.j["materials"] = json::array({{{"pbrMetallicRoughness", surface}}});
  const int positions = gltf.floats(kSquare, "VEC3", 3),
            uvs = gltf.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  gltf.single({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
               {"indices", gltf.indices<std::uint16_t>({0, 1, 2})},
               {"material", 0}});
  const LoadedScene loaded = load(folder.write("a.glb", gltf.glb()), {.encoded_textures = true});
  ASSERT_EQ(loaded.scene.textures.size(), 1u);
  EXPECT_EQ(text_of(loaded.scene.textures[0].encoded), bytes);
}

}  // namespace
}  // namespace atlas::test
