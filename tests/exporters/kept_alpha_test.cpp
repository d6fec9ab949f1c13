// Alpha of vertices in scenes that are kept: glTF has room for it, OBJ has none. Files are read
// back by a reader that is independent of the library's own.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/exporters/kept_gltf.h"

namespace atlas {
namespace {

using test::Gltf;
using test::GltfOracle;
using test::TempFolder;
using Lines = std::vector<std::string>;

const ReadOptions kKept{.keep_scene = true};

// Returns a triangle whose three lines `x y z` continue with these numbers.
std::string ply(const std::string& properties, const Lines& values) {
  const char* places[] = {"0 0 0 ", "1 0 0 ", "0 1 0 "};
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\n" +
      properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (int v = 0; v < 3; ++v) text += places[v] + values[std::size_t(v)] + "\n";
  return text + "3 0 1 2\n";
}

constexpr const char* kColours =
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";

// Returns the colours of the corners of the only triangle.
std::vector<double> colours_of(const std::filesystem::path& gltf) {
  const auto triangles = GltfOracle(gltf).triangles();
  return triangles.size() == 1 && triangles[0].attributes.contains("COLOR_0")
             ? triangles[0].attributes.at("COLOR_0")
             : std::vector<double>{};
}

TEST(KeptAlpha, OfPlyIsWrittenToGltfAndCountedInObj) {
  const TempFolder folder;
  const auto input =
      folder.write("t.ply", ply(kColours, {"255 0 0 51", "0 255 0 255", "0 0 255 0"}));
  EXPECT_EQ(test::read_and_keep(input, folder / "w.glb", kKept).not_kept, Lines{});
  const std::vector<double> wanted{1, 0, 0, 0.2f, 0, 1, 0, 1, 0, 0, 1, 0};
  EXPECT_EQ(colours_of(folder / "w.glb"), wanted);
  EXPECT_EQ(test::read_and_keep(input, folder / "w.obj", kKept).not_kept,
            Lines{"2 x values of vertices: alpha"});
  // What was written is read again, and kept once more.
  EXPECT_EQ(test::keep(folder / "w.glb", folder / "again.gltf").not_kept, Lines{});
  EXPECT_EQ(colours_of(folder / "again.gltf"), wanted);
}

TEST(KeptAlpha, OfOneEverywhereIsNotWritten) {
  const TempFolder folder;
  const auto input =
      folder.write("t.ply", ply(kColours, {"255 0 0 255", "0 255 0 255", "0 0 255 255"}));
  EXPECT_EQ(test::read_and_keep(input, folder / "w.glb", kKept).not_kept, Lines{});
  EXPECT_EQ(colours_of(folder / "w.glb"), (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(test::read_and_keep(input, folder / "w.obj", kKept).not_kept, Lines{});
}

// Black is no light, but black that is transparent is a colour.
TEST(KeptAlpha, OfBlackIsWritten) {
  const TempFolder folder;
  const auto input = folder.write("t.ply", ply(kColours, {"0 0 0 0", "0 0 0 255", "0 0 0 0"}));
  EXPECT_EQ(test::read_and_keep(input, folder / "w.glb", kKept).not_kept, Lines{});
  EXPECT_EQ(colours_of(folder / "w.glb"),
            (std::vector<double>{0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0}));
}

TEST(KeptAlpha, WithoutColoursOrBeyondItsRangeIsCounted) {
  const TempFolder folder;
  const std::string floats =
      "property float red\nproperty float green\nproperty float blue\n"
      "property float alpha\n";
  const struct {
    std::string ply;
    Lines lost;
  } cases[] = {
      {ply("property uchar alpha\n", {"7", "255", "255"}), {"1 x values of vertices: alpha"}},
      {ply(floats, {"0 0 2 0.5", "0 0 1 0.5", "0 0 1 1"}), {"2 x values of vertices: alpha"}},
      {ply(floats, {"0 0 1 -1", "0 0 1 nan", "0 0 1 2"}), {"3 x values of vertices: alpha"}},
      {ply(floats, {"0 0 1 -1", "0 0 1 0.5", "0 0 1 1"}), {"1 x values of vertices: alpha"}},
  };
  for (const auto& c : cases) {
    const auto input = folder.write("t.ply", c.ply);
    EXPECT_EQ(test::read_and_keep(input, folder / "w.glb", kKept).not_kept, c.lost);
  }
  EXPECT_EQ(colours_of(folder / "w.glb"),
            (std::vector<double>{0, 0, 1, 1, 0, 0, 1, 0.5, 0, 0, 1, 1}));
}

// Whole numbers up to 255 are shares of it, by themselves for colours and alpha.
TEST(KeptAlpha, OfOffIsRead) {
  const TempFolder folder;
  const struct {
    const char *first, *second;
    double alpha;
  } cases[] = {{"255 0 0 51", "0 0 0 255", 0.2f},
               {"1 0 0 51", "0 0 0 255", 0.2f},
               {"255 0 0 0.25", "0 0 0 1", 0.25},
               {"1.0 0 0 0.25", "0 0 0", 0.25},
               {"255 0 0 51", "0 0 0", 0.2f}};
  for (const auto& c : cases) {
    const auto input =
        folder.write("t.off", std::string("COFF\n3 1 0\n0 0 0 ") + c.first + "\n1 0 0 " + c.second +
                                  "\n0 1 0 " + c.second + "\n3 0 1 2\n");
    EXPECT_EQ(test::read_and_keep(input, folder / "w.glb", kKept).not_kept, Lines{});
    EXPECT_EQ(colours_of(folder / "w.glb"),
              (std::vector<double>{1, 0, 0, c.alpha, 0, 0, 0, 1, 0, 0, 0, 1}))
        << c.first;
  }
}

// A glTF file keeps its attribute as it is. Where its arrays are written instead, they hold alpha.
TEST(KeptAlpha, OfGltfIsReadAndCountedInObj) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int colours = gltf.accessor(
      {{"bufferView",
        gltf.view(std::vector<std::uint8_t>{255, 0, 0, 51, 0, 255, 0, 255, 0, 0, 255, 0})},
       {"componentType", 5121},
       {"normalized", true},
       {"type", "VEC4"},
       {"count", 3}});
  gltf.single({{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}}});
  const auto input = folder.write("t.glb", gltf.glb());
  EXPECT_EQ(test::keep(input, folder / "w.obj").not_kept, Lines{"2 x values of vertices: alpha"});
  auto loaded = read_scene(input, kKept, {});
  ASSERT_TRUE(loaded.ok());
  loaded->scene.source = nullptr;
  const auto written = test::write_kept(test::world_of(loaded->scene), folder / "w.glb");
  ASSERT_TRUE(written.ok()) << written.status().message();
  EXPECT_EQ(written->not_kept, Lines{});
  EXPECT_EQ(colours_of(folder / "w.glb"),
            (std::vector<double>{1, 0, 0, 0.2f, 0, 1, 0, 1, 0, 0, 1, 0}));
}

// Parts whose vertices are opaque need no fourth component.
TEST(KeptAlpha, IsWrittenWhereAPartHasIt) {
  const TempFolder folder;
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  scene.illumination.assign(6, {0.5f, 0.5f, 0.5f});
  scene.vertex_opacity = {1, 1, 1, 1, 0.5f, 1};
  scene.indices = {0, 1, 2, 3, 4, 5};
  scene.materials.resize(1);
  scene.triangle_material = {0, 0};
  scene.object_names = {"a", "b"};
  scene.triangle_object = {0, 1};
  ASSERT_TRUE(test::write_kept(test::world_of(scene), folder / "w.gltf").ok());
  const auto triangles = GltfOracle(folder / "w.gltf").triangles();
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[0].attributes.at("COLOR_0").size(), 9u);
  EXPECT_EQ(triangles[1].attributes.at("COLOR_0"),
            (std::vector<double>{0.5, 0.5, 0.5, 1, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1}));
}

}  // namespace
}  // namespace atlas
