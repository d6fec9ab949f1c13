// Exports that keep a lit scene: its light is on a lightmap, which the new uvs address.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/pipeline/lightmap.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/uv_page.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/pipeline/look_up.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/kept_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// Light that the triangles interpolate exactly, whatever their vertices are.
std::array<double, 3> light_at(double x, double y, double z) {
  return {900 + 120 * x, 700 - 80 * y + 40 * z, 500 + 60 * z};
}

// Returns a torus of two materials, neither of which reflects all light.
LoadedScene torus_scene() {
  LoadedScene loaded = lit_scene(torus(48, 24));
  Scene& scene = loaded.scene;
  scene.materials = {{"brick", {0.6f, 0.2f, 0.1f}, -1}, {"soot", {0.02f, 0.02f, 0.02f}, -1}};
  for (std::size_t t = 0; t < scene.triangle_count(); ++t)
    scene.triangle_material[t] = scene.positions[scene.indices[3 * t]].x > 0;
  for (std::size_t i = 0; i < scene.positions.size(); ++i) {
    const Vec3f p = scene.positions[i];
    const auto light = light_at(p.x, p.y, p.z);
    scene.illumination[i] = {float(light[0]), float(light[1]), float(light[2])};
  }
  EXPECT_TRUE(complete_scene(scene).ok());
  return loaded;
}

ExportOptions lightmap_options(const std::filesystem::path& target) {
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.target = target;
  options.atlas_size = 512;
  options.keep_scene = true;
  options.exr = true;
  options.threshold = 0;
  return options;
}

double srgb_decoded(double code) {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

// Compares both images of each page with the light at points of the triangles, whose uvs `uv_of`
// returns.
template <class UvOf>
void expect_light(const std::vector<KeptTriangle>& triangles, const UvOf& uv_of,
                  const std::filesystem::path& folder, const Lightmap& map) {
  std::vector<ImageF> lights;
  std::vector<Image8> displays;
  for (std::size_t p = 0; p < map.images.size(); ++p) {
    const Result<ImageF> light = read_image_float(folder / map.linear.at(p));
    const Result<Image8> display = read_image8(folder / map.images[p]);
    ASSERT_TRUE(light.ok() && display.ok());
    ASSERT_EQ(light->width, display->width);
    lights.push_back(*light);
    displays.push_back(*display);
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  for (const KeptTriangle& t : triangles) {
    double a = share(random), b = share(random);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const double weights[3] = {a, b, 1 - a - b};
    double p[3] = {}, u = 0, v = 0;
    for (int c = 0; c < 3; ++c) {
      const KeptCorner& corner = t.corners[std::size_t(c)];
      p[0] += weights[c] * corner.position.x;
      p[1] += weights[c] * corner.position.y;
      p[2] += weights[c] * corner.position.z;
      u += weights[c] * uv_of(corner).x;
      v += weights[c] * uv_of(corner).y;
    }
    const auto wanted = light_at(p[0], p[1], p[2]);
    for (int k = 0; k < 3; ++k) {
      const double light = look_up(lights.at(t.page), u, v, k);
      ASSERT_NEAR(light, wanted[std::size_t(k)], 4);  // of 400 to 1300
      const double shown = map.white * srgb_decoded(look_up(displays.at(t.page), u, v, k) / 255);
      ASSERT_NEAR(shown, std::min(map.white, wanted[std::size_t(k)]), 0.01 * map.white);
    }
  }
}

TEST(Lightmap, HoldsTheLightThatFallsOnAKeptScene) {
  const LoadedScene scene = torus_scene();
  for (const char* name : {"w.glb", "w.gltf", "w.obj"}) {
    const TempFolder folder;
    const ExportOptions options = lightmap_options(folder / name);
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    EXPECT_EQ(report->triangles_out, scene.scene.triangle_count());
    EXPECT_FALSE(report->simplified);
    ASSERT_EQ(report->pages.size(), 1u);
    EXPECT_LE(report->pages[0].width, 512);
    const Lightmap map = lightmap_of(*report, options);
    EXPECT_EQ(map.images, std::vector<std::string>{"w_0.png"});
    EXPECT_EQ(map.linear, std::vector<std::string>{"w_0.exr"});
    EXPECT_GT(map.white, 500);
    if (name == std::string("w.obj")) {
      const auto kept = read_kept_obj(folder / name);
      ASSERT_EQ(kept.size(), scene.scene.triangle_count());
      expect_light(
          kept, [](const KeptCorner& c) { return c.texcoord; }, folder.path(), map);
      const std::string text = TempFolder::read(folder / name);
      EXPECT_NE(text.find("# lightmap: w_0.png (sRGB-encoded, white is "), std::string::npos);
      const std::size_t vertex = text.find("\nv ") + 1;
      const std::string line = text.substr(vertex, text.find('\n', vertex) - vertex);
      EXPECT_EQ(std::count(line.begin(), line.end(), ' '), 3) << line;  // no light
    } else {
      const auto kept = read_kept_gltf(folder / name);
      ASSERT_EQ(kept.size(), scene.scene.triangle_count());
      expect_light(
          kept, [](const KeptCorner& c) { return c.uv; }, folder.path(), map);
      const GltfOracle file(folder / name);
      const json& named = file.document["asset"]["extras"]["lightmap"];
      EXPECT_EQ(named["images"], json(map.images));
      EXPECT_EQ(named["linear"], json(map.linear));
      EXPECT_EQ(named["texCoord"], 1);
      EXPECT_EQ(named["white"], map.white);
      EXPECT_EQ(file.document["materials"].size(), 2u);
      for (const OracleTriangle& t : file.triangles()) {
        EXPECT_FALSE(t.attributes.contains("COLOR_0") || t.attributes.contains("_ILLUMINANCE"));
      }
    }
  }
}

// Returns the page that the extras of each primitive name, or null.
std::vector<json> named_pages(const std::filesystem::path& path) {
  std::vector<json> pages;
  const GltfOracle file(path);
  for (const json& mesh : file.document["meshes"])
    for (const json& primitive : mesh["primitives"])
      pages.push_back(primitive.value("extras", json::object()).value("lightmap", json()));
  return pages;
}

// Returns options that need several pages, each too small for the whole torus.
ExportOptions options_of_pages(const std::filesystem::path& target) {
  ExportOptions options = lightmap_options(target);
  options.lightmap_pages = 3;
  options.atlas_size = 256;
  return options;
}

TEST(Lightmap, HasSeveralPages) {
  const LoadedScene scene = torus_scene();
  const TempFolder folder;
  const ExportOptions options = options_of_pages(folder / "w.glb");
  const auto report = export_world(scene, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->pages.size(), 3u);
  const Lightmap map = lightmap_of(*report, options);
  EXPECT_EQ(map.images, (std::vector<std::string>{"w_0.png", "w_1.png", "w_2.png"}));
  EXPECT_EQ(map.linear, (std::vector<std::string>{"w_0.exr", "w_1.exr", "w_2.exr"}));
  EXPECT_TRUE(lightmap_text(map).starts_with("lightmap: w_0.png to w_2.png (sRGB"))
      << lightmap_text(map);
  for (const PageReport& page : report->pages) EXPECT_EQ(page.width, page.height);
  const auto kept = read_kept_gltf(folder / "w.glb");
  ASSERT_EQ(kept.size(), scene.scene.triangle_count());
  expect_light(
      kept, [](const KeptCorner& c) { return c.uv; }, folder.path(), map);
  EXPECT_EQ(
      GltfOracle(folder / "w.glb").document["asset"]["extras"]["info"][1],
      fmt::format("TEXCOORD_1: {}", uv_page_text(report->pages[0].width, report->pages[0].height)));
}

// A primitive of a file that is kept becomes one for each page that it is on, with all that it had.
TEST(Lightmap, SplitsPrimitivesOfAKeptGltfFileByPage) {
  const TempFolder folder;
  LoadedScene plain = torus_scene();
  plain.scene.illumination.clear();
  ExportOptions options = lightmap_options(folder / "a.glb");
  options.exr = false;
  ASSERT_TRUE(export_world(plain, options, {}, {}).ok());
  auto loaded = read_scene(folder / "a.glb", {.keep_scene = true}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ASSERT_TRUE(loaded->scene.source);
  for (const Vec3f& p : loaded->scene.positions) {
    const auto values = light_at(p.x, p.y, p.z);
    loaded->scene.illumination.push_back({float(values[0]), float(values[1]), float(values[2])});
  }
  options = options_of_pages(folder / "b.glb");
  options.uv_set = 1;
  const auto report = export_world(*loaded, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  const auto kept = read_kept_gltf(folder / "b.glb");
  ASSERT_EQ(kept.size(), plain.scene.triangle_count());
  expect_light(
      kept, [](const KeptCorner& c) { return c.uv; }, folder.path(), lightmap_of(*report, options));
  const std::vector<json> pages = named_pages(folder / "b.glb");
  EXPECT_GT(pages.size(), 2u);  // one for each material before
  EXPECT_EQ(std::count(pages.begin(), pages.end(), json()), 0);
  const auto& materials = plain.scene.triangle_material;
  EXPECT_EQ(std::count_if(kept.begin(), kept.end(),
                          [](const KeptTriangle& t) { return t.material == "brick"; }),
            std::count(materials.begin(), materials.end(), 0u));

  // A lightmap of one page names none, nor do uvs in the place of its own.
  const auto again = read_scene(folder / "b.glb", {.keep_scene = true}, {});
  ASSERT_TRUE(again.ok()) << again.status().message();
  ExportOptions uvs = lightmap_options(folder / "c.glb");
  uvs.charts_only = true;
  uvs.exr = false;
  ASSERT_TRUE(export_world(*again, uvs, {}, {}).ok());
  EXPECT_EQ(named_pages(folder / "c.glb"), pages);
  uvs.uv_set = 1;
  ASSERT_TRUE(export_world(*again, uvs, {}, {}).ok());
  EXPECT_EQ(named_pages(folder / "c.glb"), std::vector<json>(pages.size()));
}

TEST(Lightmap, OfAnObjHasOnePageAndSoHaveUvsWithoutLight) {
  const TempFolder folder;
  ExportOptions options = options_of_pages(folder / "w.obj");
  const auto refusal = [&] {
    const auto report = export_world(torus_scene(), options, {}, {});
    EXPECT_EQ(report.status().code(), ErrorCode::bad_option);
    return report.status().message();
  };
  EXPECT_TRUE(refusal().starts_with("ExportOptions::lightmap_pages: an .obj")) << refusal();
  options.lightmap_pages = 0;
  EXPECT_EQ(refusal(), "ExportOptions::lightmap_pages must be at least 1");
  options = lightmap_options(folder / "w.glb");
  options.charts_only = true;
  options.plain_pages = 2;
  EXPECT_TRUE(refusal().starts_with("ExportOptions::keep_scene: a scene that is kept has uvs"))
      << refusal();
}

// A curve bends the light of the PNG, so no factor turns it into light again.
TEST(Lightmap, NamesNoWhiteAfterAToneCurve) {
  const TempFolder folder;
  ExportOptions options = lightmap_options(folder / "w.glb");
  options.exr = false;
  options.tone.op = ToneOperator::reinhard;
  const auto report = export_world(torus_scene(), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_EQ(lightmap_text(lightmap_of(*report, options)),
            "lightmap: w_0.png (sRGB-encoded, after the tone curve)");
  const json map = GltfOracle(folder / "w.glb").document["asset"]["extras"]["lightmap"];
  EXPECT_FALSE(map.contains("white"));
  EXPECT_EQ(map["images"], json::array({"w_0.png"}));
  EXPECT_FALSE(map.contains("linear"));
  EXPECT_FALSE(std::filesystem::exists(folder / "w_0.exr"));
}

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

// Alpha of vertices is the fourth component of colours, which are white then.
TEST(Lightmap, LeavesTheAlphaOfVertices) {
  const TempFolder folder;
  LoadedScene scene = torus_scene();
  scene.scene.vertex_opacity.assign(scene.scene.positions.size(), 0.25f);
  const auto report = export_world(scene, lightmap_options(folder / "w.glb"), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_TRUE(report->not_kept.empty());
  for (const OracleTriangle& t : GltfOracle(folder / "w.glb").triangles()) {
    const std::vector<double>& colours = t.attributes.at("COLOR_0");
    ASSERT_EQ(colours.size(), 12u);
    for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(colours[k], k % 4 == 3 ? 0.25 : 1);
  }
}

// A second run adds its own, or replaces the first one with its uvs; it does not leave a name of
// images that no uvs address.
TEST(Lightmap, IsNamedOnceInAFileThatIsExportedAgain) {
  const TempFolder folder;
  ASSERT_TRUE(export_world(torus_scene(), lightmap_options(folder / "a.glb"), {}, {}).ok());
  const auto loaded = read_scene(folder / "a.glb", {.keep_scene = true}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_FALSE(loaded->scene.lit());
  const auto map_of = [&](int uv_set) {
    ExportOptions options = lightmap_options(folder / "b.glb");
    options.charts_only = true;
    options.uv_set = uv_set;
    EXPECT_TRUE(export_world(*loaded, options, {}, {}).ok());
    return GltfOracle(folder / "b.glb").document["asset"]["extras"].value("lightmap", json());
  };
  EXPECT_EQ(map_of(0).value("texCoord", 0), 1);  // the new uvs are the third set
  EXPECT_TRUE(map_of(1).is_null());
}

TEST(Lightmap, ThePlanSaysWhatItHolds) {
  const ExportOptions options = lightmap_options("w.glb");
  const ExportPlan plan = make_plan(torus_scene().scene, options);
  EXPECT_TRUE(plan.bake);
  EXPECT_FALSE(plan.simplify || plan.sample_reflectance);
  const auto reason = [&](const std::string& stage) {
    for (const PlanStep& step : plan.steps)
      if (step.stage == stage) return (step.run ? "run: " : "skip: ") + step.reason;
    return std::string("none");
  };
  EXPECT_EQ(reason("reflectance"), "skip: a lightmap holds the light that falls on surfaces");
  EXPECT_EQ(reason("simplify"), "skip: the scene is kept");
  EXPECT_EQ(reason("grouping"), "skip: one page");
}

}  // namespace
}  // namespace atlas::test
