// Lightmaps of kept glTF files whose vertices have colours: which of them are light.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lightmap_export.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// Three squares that stand apart: the colours of the first are light, the second is lit by another
// attribute, so that its colours are its own, and the third is unlit.
Gltf three_squares() {
  Gltf gltf;
  const std::vector<std::uint16_t> corners{0, 1, 2, 0, 2, 3};
  const int positions = gltf.floats(kSquare, "VEC3", 3), indices = gltf.indices(corners);
  const int colours =
      gltf.floats({1, 0, 0, 0.5f, 1, 1, 0, 0.5f, 1, 0, 0, 1, 0, 1, 1, 1}, "VEC4", 4);
  const int light = gltf.floats({9, 8, 7, 9, 8, 8, 9, 7, 7, 9, 8, 5}, "VEC3", 3);
  json nodes = json::array(), meshes = json::array();
  for (int i = 0; i < 3; ++i) {
    json primitive = {{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}},
                      {"indices", indices},
                      {"material", i == 2 ? 1 : 0}};
    if (i == 1) primitive["attributes"]["_ILLUMINANCE"] = light;
    meshes.push_back({{"primitives", json::array({primitive})}});
    nodes.push_back({{"mesh", i}, {"translation", {2 * i, 0, 0}}, {"name", std::to_string(i)}});
  }
  gltf.j["materials"] = {
      {{"name", "lit"}},
      {{"name", "unlit"}, {"extensions", {{"KHR_materials_unlit", json::object()}}}}};
  gltf.j["extensionsUsed"] = {"KHR_materials_unlit"};
  gltf.j["meshes"] = meshes;
  gltf.j["nodes"] = nodes;
  gltf.j["scenes"] = {{{"nodes", {0, 1, 2}}}};
  gltf.j["scene"] = 0;
  return gltf;
}

// Viewers multiply base colours by COLOR_0, which would darken lit surfaces by their light again.
TEST(Lightmap, TakesTheLightOutOfAKeptGltfFile) {
  const TempFolder folder;
  const auto loaded =
      read_scene(folder.write("scene.glb", three_squares().glb()), {.keep_scene = true}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ExportOptions options = lightmap_options(folder / "w.glb");
  const auto report = export_world(*loaded, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_EQ(report->not_kept, std::vector<std::string>{"4 x values of vertices: alpha"});
  for (const OracleTriangle& t : GltfOracle(folder / "w.glb").triangles()) {
    EXPECT_FALSE(t.attributes.contains("_ILLUMINANCE")) << t.node;
    EXPECT_EQ(t.attributes.contains("COLOR_0"), t.node != "0") << t.node;
    EXPECT_TRUE(t.attributes.contains("TEXCOORD_1")) << t.node;
  }
  // Without a lightmap, all stays.
  options.charts_only = true;
  options.exr = false;
  ASSERT_TRUE(export_world(*loaded, options, {}, {}).ok());
  const GltfOracle plain(folder / "w.glb");
  EXPECT_FALSE(plain.document["asset"]["extras"].contains("lightmap"));
  for (const OracleTriangle& t : plain.triangles()) {
    EXPECT_EQ(t.attributes.contains("_ILLUMINANCE"), t.node == "1");
    EXPECT_TRUE(t.attributes.contains("COLOR_0"));
  }
}

// The corners of a square with these colours, which are those of `more` sets and of a morph target,
// too.
Gltf coloured_square(const std::vector<float>& colours, int more = 0) {
  Gltf gltf;
  json attributes = {{"POSITION", gltf.floats(kSquare, "VEC3", 3)},
                     {"COLOR_0", gltf.floats(colours, "VEC3", 3)}};
  json target = {{"POSITION", gltf.floats(std::vector<float>(12, 0), "VEC3", 3)}};
  for (int set = 1; set <= more; ++set) {
    const std::vector<float> values(12, 0.125f * float(set));
    attributes[fmt::format("COLOR_{}", set)] = gltf.floats(values, "VEC3", 3);
    target[fmt::format("COLOR_{}", set)] = gltf.floats(values, "VEC3", 3);
  }
  json primitive = {{"attributes", attributes},
                    {"indices", gltf.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}};
  if (more > 0) primitive["targets"] = json::array({target});
  gltf.single(primitive);
  return gltf;
}

// The format allows no set of colours without those before it.
TEST(Lightmap, SetsOfColoursMoveUpWhenTheFirstIsLight) {
  const TempFolder folder;
  const Gltf square = coloured_square({2, 0, 0, 0, 2, 0, 0, 0, 2, 2, 2, 2}, 11);
  const auto loaded = read_scene(folder.write("scene.glb", square.glb()), {.keep_scene = true}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const auto report = export_world(*loaded, lightmap_options(folder / "w.glb"), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  const GltfOracle oracle(folder / "w.glb");
  const json& primitive = oracle.document["meshes"][0]["primitives"][0];
  for (const json& names : {primitive["attributes"], primitive["targets"][0]}) {
    for (int set = 0; set < 11; ++set)
      EXPECT_TRUE(names.contains(fmt::format("COLOR_{}", set))) << set;
    EXPECT_FALSE(names.contains("COLOR_11"));
  }
  for (const OracleTriangle& t : oracle.triangles())
    for (int set = 0; set < 11; ++set)
      EXPECT_EQ(t.attributes.at(fmt::format("COLOR_{}", set))[0], 0.125 * (set + 1));
}

// The format takes COLOR_0 as paint, as most files do. What proves it to be light is said.
TEST(Lightmap, ColoursOfAKeptGltfFileAreLightOnlyWhereProven) {
  const TempFolder folder;
  struct Case {
    std::vector<float> colours;
    bool asked, light;
    const char* line;
  };
  const std::vector<float> paint{1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0.5f},
      bright{1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1.5f};
  const Case cases[] = {{paint, false, false, "COLOR_0 is taken as paint and stays"},
                        {paint, true, true, "as ExportOptions::colours_are_light says"},
                        {bright, false, true, "since values are beyond 1"}};
  for (const Case& c : cases) {
    const auto loaded = read_scene(folder.write("scene.glb", coloured_square(c.colours).glb()),
                                   {.keep_scene = true}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    for (const char* name : {"w.glb", "w.obj"}) {
      const std::filesystem::path image = folder / "w_0.png";
      std::filesystem::remove(image);
      ExportOptions options = lightmap_options(folder / name);
      options.colours_are_light = c.asked;
      std::string lines;
      Context context;
      context.warn = [&](std::string_view line) { lines += std::string(line) + "\n"; };
      const auto report = export_world(*loaded, options, {}, context);
      ASSERT_TRUE(report.ok()) << report.status().message();
      EXPECT_NE(lines.find(c.line), std::string::npos) << lines;
      EXPECT_EQ(std::filesystem::exists(image), c.light) << name;
    }
    for (const OracleTriangle& t : GltfOracle(folder / "w.glb").triangles())
      EXPECT_EQ(t.attributes.contains("COLOR_0"), !c.light);
    std::ifstream obj(folder / "w.obj");
    const std::string text((std::istreambuf_iterator<char>(obj)), {});
    EXPECT_EQ(text.find("\nv 0 0 0 1 0 0\n") != std::string::npos, !c.light) << text;
  }
}

// What is lit by another file gets no light beside its map, either.
TEST(Lightmap, TakesThePlaceOfLightFromAnotherFile) {
  const TempFolder folder;
  Gltf gltf;
  gltf.single({{"attributes", {{"POSITION", gltf.floats(kSquare, "VEC3", 3)}}},
               {"indices", gltf.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
  const auto loaded =
      read_scene(folder.write("scene.glb", gltf.glb()),
                 {.illumination_file = folder.write("light.txt", "1 2 3\n2 2 2\n3 1 1\n4 4 4\n"),
                  .keep_scene = true},
                 {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ExportOptions options = lightmap_options(folder / "w.glb");
  for (const bool map : {true, false}) {
    options.charts_only = !map;
    options.exr = map;
    ASSERT_TRUE(export_world(*loaded, options, {}, {}).ok());
    const auto triangles = GltfOracle(folder / "w.glb").triangles();
    ASSERT_EQ(triangles.size(), 2u);
    for (const OracleTriangle& t : triangles)
      EXPECT_EQ(t.attributes.contains("_ILLUMINANCE"), !map);
  }
}

}  // namespace
}  // namespace atlas::test
