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
#include "tests/pipeline/lightmap_export.h"
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
