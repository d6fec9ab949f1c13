// Lightmaps that exports have written are read again with ReadOptions::lightmap.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/check_scene.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/pipeline/look_up.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

Vec3f light_at(const Vec3f& p) {
  return {900 + 120 * p.x, 700 - 80 * p.y + 40 * p.z, 500 + 60 * p.z};
}

LoadedScene lit_torus() {
  LoadedScene loaded = lit_scene(torus(48, 24));
  Scene& scene = loaded.scene;
  for (std::size_t i = 0; i < scene.positions.size(); ++i)
    scene.illumination[i] = light_at(scene.positions[i]);
  return loaded;
}

struct Written {
  const char* name;
  std::uint32_t pages;
  bool exr;
  ToneOperator tone;
};

TEST(ReadLightmap, GivesTheLightBack) {
  const LoadedScene scene = lit_torus();
  for (const Written& c : {Written{"w.glb", 3, true, ToneOperator::linear},
                           {"w.gltf", 3, false, ToneOperator::linear},
                           {"w.obj", 1, true, ToneOperator::linear},
                           {"w.obj", 1, false, ToneOperator::linear},
                           {"w.obj", 1, false, ToneOperator::reinhard},
                           {"100% w.glb", 1, true, ToneOperator::linear}}) {
    const TempFolder folder;
    ExportOptions options;
    options.packing = PackPreset::fast;
    options.target = folder / c.name;
    options.atlas_size = c.pages > 1 ? 256 : 512;
    options.lightmap_pages = c.pages;
    options.keep_scene = true;
    options.exr = c.exr;
    options.tone.op = c.tone;
    options.threshold = 0;
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    const auto read = read_scene(folder / c.name, {.lightmap = true}, {});
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_TRUE(read->defects.empty()) << read->defects.lines()[0];
    EXPECT_EQ(check_scene(read->scene).message(), "");
    ASSERT_TRUE(read->scene.lightmap) << c.name;
    const SceneLightmap& map = *read->scene.lightmap;
    EXPECT_EQ(map.pages.size(), c.pages);
    const auto images = std::count_if(
        read->files.begin(), read->files.end(),
        [&](const auto& file) { return file.extension() == (c.exr ? ".exr" : ".png"); });
    EXPECT_EQ(images, std::ptrdiff_t(c.pages));
    EXPECT_EQ(read->unread_files.size(), c.exr ? c.pages : 0);
    const auto white = float(report->exposure_white);
    if (c.tone == ToneOperator::linear)
      EXPECT_NEAR(map.white, white, 1e-3f * white) << "an .obj has four digits";
    else
      EXPECT_EQ(map.white, 0);
    const Scene& s = read->scene;
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < s.indices.size() && c.tone == ToneOperator::linear; ++k) {
      const Vec3f wanted = light_at(s.positions[s.indices[k]]);
      const Vec2f uv = map.texcoords[map.texcoord_indices[k]];
      const float most = c.exr ? 1e9f : white, error = c.exr ? 4 : 0.01f * white;
      const ImageF& page = map.pages[map.triangle_page[k / 3]];
      wrong += std::abs(look_up(page, uv.x, uv.y, 0) - std::min(wanted.x, most)) > error ||
               std::abs(look_up(page, uv.x, uv.y, 2) - std::min(wanted.z, most)) > error;
    }
    // Between the banks of a slit, both are mixed.
    EXPECT_LE(wrong, s.indices.size() / 1000) << c.name;
    EXPECT_FALSE(read_scene(folder / c.name, {}, {})->scene.lightmap);
  }
}

// Comments that only look like it, and files without their images.
TEST(ReadLightmap, OfAnObjThatIsDamaged) {
  const TempFolder folder;
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
  const auto read = [&](const std::string& comment, const std::string& faces) {
    return std::move(
        read_scene(folder.write("a.obj", comment + "\n" + faces), {.lightmap = true}, {}).value());
  };
  for (const char* none :
       {"# lightmap: a.png", "# lightmap:", "# lightmap: a.png (sRGB-encoded, white is x of)",
        "# lightmap: a.png (sRGB-encoded, white is 0 of)",
        "# lightmap: a.png (sRGB-encoded, white is nan", "# lightmap: a.png (sRGB-encoded",
        "# lightmap: a.png (sRGB-encoded, white is 1e60", "lightmap (sRGB-encoded, "}) {
    const LoadedScene scene = read(none, mesh);
    EXPECT_FALSE(scene.scene.lightmap) << none;
    EXPECT_EQ(scene.defects.count(DefectKind::lightmap_unusable), 0u) << none;
  }
  for (const char* gone :
       {"# lightmap: a.png (sRGB-encoded, after", "# lightmap:  (sRGB-encoded, white is 3",
        "# lightmap: a.png (sRGB-encoded, white is 3), ../b.exr (linear)\r",
        "# lightmap: a.png (sRGB-encoded, white is 3),  (linear)"}) {
    const LoadedScene scene = read(gone, mesh);
    EXPECT_FALSE(scene.scene.lightmap) << gone;
    EXPECT_EQ(scene.defects.count(DefectKind::lightmap_unusable), 1u) << gone;
  }
}

TEST(ReadLightmap, OfAnObjNeedsItsTextureCoordinates) {
  const TempFolder folder;
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 255), {}).ok());
  const std::string head =
      "# lightmap: a.png (sRGB-encoded, white is 5 of it)\n"
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
  const auto read = [&](const std::string& faces) {
    LoadedScene loaded =
        std::move(read_scene(folder.write("a.obj", head + faces), {.lightmap = true}, {}).value());
    EXPECT_EQ(check_scene(loaded.scene).message(), "");
    return loaded;
  };
  LoadedScene some = read("f 1 2 3\nf 1/1 2/1 3/1\nf 3 2 1\n");
  EXPECT_EQ(some.defects.count(DefectKind::lightmap_absent), 2u);
  ASSERT_TRUE(some.scene.lightmap);
  EXPECT_EQ(some.scene.lightmap->texcoord_indices[0], Scene::kNoTexcoord);
  EXPECT_EQ(some.scene.lightmap->texcoord_indices[3], 0u);
  EXPECT_EQ(some.scene.lightmap->pages[0].texels[0], 5);
  EXPECT_EQ(some.scene.lightmap->white, 5);
  some = read("f 1 2 3\n");
  EXPECT_EQ(some.defects.count(DefectKind::lightmap_unusable), 1u);
  EXPECT_FALSE(some.scene.lightmap);
}

}  // namespace
}  // namespace atlas::test
