// Kept glTF scenes of which only some parts have uvs of their own: the file says the page of the
// new uvs, which the other parts have in all sets.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "libatlas/scene/uv_page.h"
#include "tests/exporters/kept_gltf.h"

namespace atlas {
namespace {

using test::GltfOracle;
using test::TempFolder;

// The page of the new uvs is four times as wide as high.
World wide_world_of(const Scene& scene) {
  World world = test::world_of(scene);
  world.info = {uv_page_text(400, 100)};
  return world;
}

// Returns width / height of the page of each material's uvs, 0 where the file does not say it.
std::map<std::string, double> aspects_of(const std::filesystem::path& path) {
  const auto loaded = read_scene(path, {}, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  std::map<std::string, double> aspects;
  for (std::size_t m = 0; loaded.ok() && m < loaded->scene.materials.size(); ++m)
    aspects[loaded->scene.materials[m].name] =
        loaded->material_uv_aspects.empty() ? loaded->uv_aspect : loaded->material_uv_aspects[m];
  return aspects;
}

using Aspects = std::map<std::string, double>;

// The triangles of "paint" get no uvs of their own, or only some of them.
Scene partly_mapped(bool all_of_paint) {
  Scene scene = test::small_scene();
  for (std::size_t k = 0; k < scene.indices.size(); ++k) {
    const std::uint32_t object = scene.triangle_object[k / 3];
    if (scene.triangle_material[k / 3] == 0 && (all_of_paint || object == 0))
      scene.texcoord_indices[k] = Scene::kNoTexcoord;
  }
  return scene;
}

void expect_kept(const World& world, const std::filesystem::path& path) {
  const auto written = test::write_kept(world, path);
  ASSERT_TRUE(written.ok()) << written.status().message();
}

// Keeps the scene once more, with further uvs on a page of another shape.
void keep_again(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto loaded = read_scene(from, test::kGltfRest, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  World world = test::world_of(loaded->scene);
  world.info = {uv_page_text(100, 300)};
  expect_kept(world, to);
}

TEST(KeptUvPages, PartsWithoutUvsOfTheirOwnHaveThePageOfTheNewOnes) {
  const TempFolder folder;
  const Scene scene = partly_mapped(true);
  expect_kept(wide_world_of(scene), folder / "w.glb");
  EXPECT_EQ(aspects_of(folder / "w.glb"), (Aspects{{"paint", 4}, {"wood # 2", 1}}));
  for (const auto& triangle : GltfOracle(folder / "w.glb").triangles()) {
    const bool same = triangle.attributes.at("TEXCOORD_0") == triangle.attributes.at("TEXCOORD_1");
    EXPECT_EQ(same, triangle.material == 0);
  }
  keep_again(folder / "w.glb", folder / "again.gltf");
  EXPECT_EQ(aspects_of(folder / "again.gltf"), (Aspects{{"paint", 4}, {"wood # 2", 1}}));
}

// One page for each material is all that readers tell.
TEST(KeptUvPages, AMaterialOfBothKindsOfUvsHasNoPage) {
  const TempFolder folder;
  const Scene scene = partly_mapped(false);
  expect_kept(wide_world_of(scene), folder / "w.glb");
  EXPECT_EQ(aspects_of(folder / "w.glb"), (Aspects{{"paint", 0}, {"wood # 2", 0}}));
}

TEST(KeptUvPages, OfGltfWithoutAllUvsAreToldLikewise) {
  const TempFolder folder;
  test::Gltf gltf = test::textured(folder);
  gltf.j["materials"][0]["name"] = "mapped";
  gltf.j["materials"].push_back({{"name", "plain"}});
  gltf.j["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", gltf.floats({0, 0, 1, 1, 0, 1, 0, 1, 1}, "VEC3", 3)}}},
       {"material", 1}});
  const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), test::kGltfRest, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  expect_kept(wide_world_of(loaded->scene), folder / "w.glb");
  EXPECT_EQ(aspects_of(folder / "w.glb"), (Aspects{{"mapped", 1}, {"plain", 4}}));
  keep_again(folder / "w.glb", folder / "again.glb");
  EXPECT_EQ(aspects_of(folder / "again.glb"), (Aspects{{"mapped", 1}, {"plain", 4}}));
}

}  // namespace
}  // namespace atlas
