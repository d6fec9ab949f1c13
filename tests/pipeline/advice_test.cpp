#include "libatlas/pipeline/advice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/scene/temp_folder.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// Returns the report of a baked export with so many charts on so many square pages.
ExportReport report_of(std::size_t charts, std::size_t pages, std::int32_t side) {
  ExportReport report;
  report.charts.resize(charts);
  report.pages.assign(pages, PageReport{"p.png", side, side, 1, 1});
  report.gpu_bytes = 1;
  report.uv_utilization = 0.7;
  return report;
}

bool holds(const std::vector<std::string>& lines, const std::string& text) {
  return lines.size() == 1 && lines[0].find(text) != std::string::npos;
}

TEST(Advice, UsualResultsNeedNone) {
  ExportOptions options;
  EXPECT_TRUE(advice_on({}, options).empty());
  EXPECT_TRUE(advice_on(report_of(16000, 50, 2048), options).empty());
  options.texel_metres = 0.005;
  EXPECT_TRUE(advice_on(report_of(16000, 64, 2048), options).empty());
}

TEST(Advice, KeptChartsOfSingleTrianglesAreNamed) {
  ExportReport report;
  ExportOptions options;
  options.charts.keep_uv_charts = true;
  report.surface_area = 1;
  report.triangles = 800;
  report.repairs.kept_charts = 782;
  EXPECT_TRUE(holds(advice_on(report, options), "kept 782 charts of 800 triangles"));
  report.repairs.kept_charts = 400;  // quads
  EXPECT_TRUE(advice_on(report, options).empty());
  report.triangles = 200;  // little can be said of few
  report.repairs.kept_charts = 200;
  EXPECT_TRUE(advice_on(report, options).empty());
}

TEST(Advice, ChartsThatRoundingStretchesAreNamed) {
  ExportReport report;
  report.charts.resize(45);
  report.written_stretch_999 = 7.6;
  EXPECT_TRUE(advice_on(report, {}).empty());
  report.charts_beyond_bound = 42;
  EXPECT_TRUE(holds(advice_on(report, {}), "42 of 45 charts are stretched more"));
  EXPECT_TRUE(holds(advice_on(report, {}), "up to 7.6 "));
}

TEST(Advice, ManyPagesNameLargerOnesThatHoldAsMuch) {
  ExportOptions options;
  EXPECT_TRUE(holds(advice_on(report_of(16000, 200, 2048), options),
                    "16000 charts on 200 pages of 2048 x 2048"));
  EXPECT_TRUE(
      holds(advice_on(report_of(16000, 200, 2048), options),
            "(ExportOptions::atlas_size 8192 ExportOptions::atlases 13 holds as much; a longer "
            "ExportOptions::texel_metres"));
  options.atlas_size = 8192;  // not all graphics cards support larger ones
  EXPECT_TRUE(holds(advice_on(report_of(16000, 200, 8192), options),
                    "(a longer ExportOptions::texel_metres"));
}

TEST(Advice, PagesOfGuttersAreNamed) {
  ExportReport report = report_of(16000, 8, 1024);
  report.uv_utilization = 0.3;
  EXPECT_TRUE(
      holds(advice_on(report, {}), "16000 charts have 157 texels each on average, and 70 %"));
  report = report_of(16, 8, 1024);  // few large charts in a long scene
  report.uv_utilization = 0.3;
  EXPECT_TRUE(advice_on(report, {}).empty());
}

// As if five metres were given where five millimetres were meant.
TEST(Advice, TexelsAsLongAsChartsAreNamed) {
  ExportReport report = report_of(16, 1, 16);
  ExportOptions options;
  EXPECT_TRUE(advice_on(report, options).empty());  // no texel size was given
  report.packed_texel = report.texel = options.texel_metres = 5;
  EXPECT_TRUE(holds(advice_on(report, options), "16 charts have 11 texels each on average, 5e+03"));
  EXPECT_TRUE(advice_on(report_of(2, 1, 16), options).empty());
}

TEST(Advice, LimitsThemselvesNeedNone) {
  ExportReport report = report_of(255, 1, 512);
  report.uv_utilization = 0.3;
  EXPECT_TRUE(advice_on(report, {}).empty());
  report.charts.resize(256);
  EXPECT_TRUE(holds(advice_on(report, {}), "256 charts have 307 texels each on average"));
  ExportOptions options;
  options.texel_metres = 0.005;
  report = report_of(100, 8, 1024);
  report.packed_texel = 0.01;
  EXPECT_TRUE(advice_on(report, options).empty());
}

// Texels that the pages could not hold are few because of the pages, not because of their length.
TEST(Advice, FewTexelsOfFullPagesAreNotCalledTooLong) {
  ExportReport report = report_of(16, 1, 16);
  report.packed_texel = 0.025;
  ExportOptions options;
  report.texel = options.texel_metres = 0.005;
  EXPECT_TRUE(holds(advice_on(report, options), "texels are 25 mm long"));
}

TEST(Advice, PagesWithoutLightNeedNone) {
  ExportReport report = report_of(16000, 200, 64);
  EXPECT_FALSE(advice_on(report, {}).empty());
  report.gpu_bytes = 0;
  EXPECT_TRUE(advice_on(report, {}).empty());
}

TEST(Advice, TransparencyIsNamed) {
  Scene scene;
  scene.materials = {{.name = "wall"}, {.name = "fence"}, {.name = "glass"}};
  scene.textures.push_back({"leaf.png", Image8(2, 2, 4)});
  scene.textures.push_back({"bark.png", Image8(2, 2, 3)});
  scene.materials[0].texture = 0;  // a fourth channel without meaning
  scene.materials[1].texture = 1;
  scene.materials[1].alpha_mode = AlphaMode::mask;  // its texture has no fourth channel
  EXPECT_TRUE(advice_on_materials(scene, Quantity::illuminance).empty());
  scene.materials[1].texture = 0;
  EXPECT_TRUE(holds(advice_on_materials(scene, Quantity::illuminance),
                    "1 material ('fence') is transparent or has holes"));
  scene.materials[2].alpha_mode = AlphaMode::blend;
  scene.materials[2].opacity = 0.3f;
  EXPECT_TRUE(holds(advice_on_materials(scene, Quantity::luminance),
                    "2 materials ('fence', ...) are transparent or have holes"));
  scene.materials[0].opacity_textured = true;
  EXPECT_TRUE(holds(advice_on_materials(scene, Quantity::illuminance), "3 materials ('wall'"));
  scene.materials[0].opacity_textured = false;
  scene.materials[0].opacity_by_view = true;
  EXPECT_TRUE(holds(advice_on_materials(scene, Quantity::illuminance), "3 materials ('wall'"));
}

TEST(Advice, UvChartsOfWhichNoneIsKeptAreNamed) {
  ExportReport report;
  ExportOptions options;
  options.charts.keep_uv_charts = true;
  EXPECT_TRUE(holds(advice_on(report, options), "ChartOptions::keep_uv_charts kept no chart"));
  report.repairs.reflattened_charts = 9;
  EXPECT_TRUE(holds(advice_on(report, options), "ChartOptions::keep_uv_charts kept no chart"));
  report.repairs.kept_charts = 1;
  EXPECT_TRUE(advice_on(report, options).empty());
}

// Luminance includes what a lamp emits; illuminance cannot.
TEST(Advice, LampsAreNamed) {
  Scene scene;
  scene.materials = {{.name = "wall"}, {.name = "lamp"}, {.name = "screen"}};
  scene.materials[1].emission = {0, 0, 2};
  EXPECT_TRUE(advice_on_materials(scene, Quantity::luminance).empty());
  EXPECT_TRUE(holds(advice_on_materials(scene, Quantity::illuminance),
                    "1 material ('lamp') emits light: it is not baked"));
  scene.materials[2].emission = {1, 1, 1};
  EXPECT_TRUE(holds(advice_on_materials(scene, Quantity::illuminance),
                    "2 materials ('lamp', ...) emit light"));
}

TEST(Advice, ALampOfAnMtlIsToldAndReported) {
  const TempFolder folder;
  folder.write("m.mtl", "newmtl lamp\nKe 5 5 5\nnewmtl unused\nKe 1 1 1\n");
  const auto scene = read_scene(folder.write("s.obj",
                                             "mtllib m.mtl\nv 0 0 0 1 1 1\nv 1 0 0 1 1 1\n"
                                             "v 0 1 0 2 2 2\nusemtl lamp\nf 1 2 3\n"),
                                {}, {});
  ASSERT_TRUE(scene.ok()) << scene.status().message();
  ExportOptions options;
  options.target = folder / "w.obj";
  const auto advice = [&] {
    const auto report = export_world(*scene, options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().message();
    return report.ok() ? report->advice : std::vector<std::string>{};
  };
  EXPECT_TRUE(holds(advice(), "1 material ('lamp') emits light"));
  options.charts_only = true;  // nothing is baked, so nothing is lost
  EXPECT_TRUE(advice().empty());
}

TEST(Advice, LightThatTheToneCurveLosesIsNamed) {
  ExportReport report = report_of(100, 8, 1024);
  report.luminance.log_average = 100;
  report.luminance.percentile99 = 700;
  const auto with_white = [&](float white) {
    report.tone.scale = 1 / white;
    report.exposure_white = white;
    ExportOptions options;
    EXPECT_TRUE(advice_on(report, options).empty()) << "as measured";
    options.tone.white = white;
    return advice_on(report, options);
  };
  EXPECT_TRUE(with_white(700).empty());
  EXPECT_TRUE(with_white(120).empty());
  EXPECT_TRUE(with_white(7e4f).empty());
  EXPECT_TRUE(
      holds(with_white(90), "light of 100, the geometric mean, is shown white like all above 90"));
  EXPECT_TRUE(holds(with_white(7e6f), "is shown black; white begins at 7e+06"));
}

// A measured white with a given exposure is no measured white. A scene without any light is black
// whatever the tone curve.
TEST(Advice, AGivenExposureCountsLikeAGivenWhite) {
  ExportReport report = report_of(100, 8, 1024);
  report.luminance.log_average = report.luminance.percentile99 = 100;
  report.tone.scale = 1.0F / 90;
  report.exposure_white = 90;
  ExportOptions options;
  EXPECT_TRUE(advice_on(report, options).empty());
  options.tone.exposure_stops = 2;
  EXPECT_TRUE(holds(advice_on(report, options), "is shown white like all above 90"));
  report.luminance = {};
  EXPECT_TRUE(advice_on(report, options).empty());
}

TEST(Advice, TexelsThatPagesCannotHoldAreNamed) {
  ExportReport report = report_of(100, 8, 1024);
  report.metres_per_unit = 0.01;
  report.packed_texel = 2.5;
  report.texel = 1;  // chosen by the plan
  EXPECT_TRUE(holds(advice_on(report, {}), "texels are 25 mm long, not the 10 mm that are usual"));
  ExportOptions options;
  report.texel = 0.5;
  options.texel_metres = 0.005;
  EXPECT_TRUE(holds(advice_on(report, options),
                    "texels are 25 mm long, not the 5 mm of ExportOptions::texel_metres"));
  report.texel = 1.25;
  EXPECT_TRUE(advice_on(report, {}).empty());
}

// Where the light is smooth, coarse texels show all of it. A length that was asked for is another
// matter, and an error that was not measured may be of any size.
TEST(Advice, CoarseTexelsThatLoseNothingAreNotNamed) {
  ExportReport report = report_of(100, 8, 1024);
  report.packed_texel = 0.025;
  report.texel = 0.01;
  report.error_measured = true;
  report.fidelity.lit = 1000;
  report.fidelity.psnr = 45;
  EXPECT_TRUE(advice_on(report, {}).empty());
  EXPECT_TRUE(holds(advice_on(report, {.texel_metres = 0.01}), "texels are 25 mm long"));
  report.fidelity.psnr = 44.9;
  EXPECT_TRUE(holds(advice_on(report, {}), "texels are 25 mm long"));
  report.fidelity.psnr = 45;
  report.error_measured = false;
  EXPECT_TRUE(holds(advice_on(report, {}), "texels are 25 mm long"));
}

// A wall of 400 m² gets texels of 40 mm on one page of 512. Its light is smooth, or a chequerboard
// of the vertices.
TEST(Advice, CoarseTexelsAreNamedWhereTheyBlurTheLight) {
  const TempFolder folder;
  LoadedScene scene = lit_scene(grid(200, 200, 20, 20));
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 1;
  options.atlas_size = 512;
  options.threshold = 0;  // smooth light would take a smaller page
  for (const bool smooth : {true, false}) {
    for (std::size_t v = 0; v < scene.scene.positions.size(); ++v) {
      const Vec3f p = scene.scene.positions[v];
      const float light = smooth ? 1 + 0.04f * p.x : float(v % 2);
      scene.scene.illumination[v] = {light, light, light};
    }
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    EXPECT_GT(report->packed_texel, 2 * report->texel);
    EXPECT_EQ(report->advice.empty(), smooth) << report->fidelity.psnr;
    EXPECT_EQ(holds(report->advice, "texels are "), !smooth);
  }
}

TEST(Advice, NoiseThatShattersChartsIsNamed) {
  ExportReport report = report_of(100, 1, 1024);
  report.noise = {100000, 60};
  EXPECT_TRUE(holds(advice_on(report, {}),
                    "60 of 100000 vertices are peaks that stretch a chart beyond the bound (smooth "
                    "the mesh first, or a larger ChartOptions::max_stretch)"));
  report.gpu_bytes = 0;  // without light
  EXPECT_EQ(advice_on(report, {}).size(), 1u);
  const auto silent = [&](auto change) {
    ExportReport other = report;
    change(other);
    return advice_on(other, {}).empty();
  };
  EXPECT_TRUE(silent([](ExportReport& r) { r.noise = {}; }));
  EXPECT_TRUE(silent([](ExportReport& r) { r.noise.vertices = 700000; }));
  EXPECT_TRUE(silent([](ExportReport& r) { r.charts.resize(47); }));
  EXPECT_TRUE(silent([](ExportReport& r) { r.noise = {10000, 10}; }));
  ExportOptions options;
  options.charts.cone_degrees = 30;  // needs many charts in any case
  EXPECT_TRUE(advice_on(report, options).empty());
}

// On an even mesh, charts grow with the mesh from a noise of 35 % on.
TEST(Advice, OnlyNoiseThatTakesManyChartsIsNamed) {
  const TempFolder folder;
  for (const double noise : {0.05, 0.15, 0.3, 0.5}) {
    const Shape ball = noisy_along_normals(geodesic_sphere(32), noise);
    LoadedScene scene;
    scene.scene.positions = ball.positions;
    scene.scene.indices = ball.indices;
    ASSERT_TRUE(complete_scene(scene.scene).ok());
    ExportOptions options;
    options.target = folder / "world.obj";
    options.charts_only = true;
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    const bool strong = noise > 0.4;
    EXPECT_EQ(report->charts.size() > 20, strong) << report->charts.size();
    EXPECT_EQ(report->advice.empty(), !strong) << noise;
    EXPECT_EQ(holds(report->advice, "rough as by scan noise"), strong);
  }
}

TEST(Advice, PagesThatLoseTheDetailOfTheLightAreNamed) {
  ExportReport report = report_of(10, 1, 1024);
  report.error_measured = true;
  report.fidelity.lit = 1000;
  report.fidelity.psnr = 34.9;
  report.plan.light_spacing_m = 0.001;
  report.packed_texel = report.texel = 0.002;
  EXPECT_TRUE(holds(advice_on(report, {}),
                    "to 34.9 dB only: their texels are 2 mm long, and the vertices that carry the "
                    "light are 1 mm apart (a shorter ExportOptions::texel_metres)"));
  report.texel = 0.0015;
  EXPECT_TRUE(holds(advice_on(report, {}), "(more ExportOptions::atlases or a larger"));
  const auto silent = [&](auto change) {
    ExportReport other = report;
    change(other);
    return advice_on(other, {}).empty();
  };
  EXPECT_TRUE(silent([](ExportReport& r) { r.fidelity.psnr = 35; }));
  EXPECT_TRUE(silent([](ExportReport& r) { r.packed_texel = 0.0005; }));
  EXPECT_TRUE(silent([](ExportReport& r) { r.error_measured = false; }));
  EXPECT_TRUE(silent([](ExportReport& r) { r.plan.light_spacing_m = 0; }));
}

// A chart that is longer than its page at full size is scaled once, as all charts are.
TEST(Advice, TexelsAreAsLongAsTheUvsOfTheWorldSay) {
  const TempFolder folder;
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 1;
  options.atlas_size = 64;
  options.texel_metres = 0.01;
  options.threshold = 0;
  options.simplify = false;
  options.charts.min_fill = 0;
  const auto report = export_world(lit_scene(grid(40, 20, 40, 20)), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  double uv_area = 0;  // in texels
  for (const PageReport& page : report->pages)
    uv_area += report->uv_utilization * double(page.width) * double(page.height);
  const double texel = std::sqrt(40 * 20 / uv_area);
  EXPECT_GT(texel, 0.3);
  EXPECT_NEAR(report->packed_texel, texel, 0.02 * texel);
  EXPECT_EQ(report->capped_charts, 0u);
  EXPECT_NEAR(report->packed_texel * report->scale, options.texel_metres, 1e-9);
  ASSERT_FALSE(report->advice.empty());
  double said = 0;
  ASSERT_EQ(std::sscanf(report->advice[0].c_str(), "texels are %lf mm long", &said), 1)
      << report->advice[0];
  EXPECT_NEAR(said, 1e3 * texel, 20 * texel);
}

TEST(Advice, AScenePutInTheDarkIsNamed) {
  ExportReport report = report_of(100, 8, 1024);
  report.luminance.unlit_area = 3;
  EXPECT_TRUE(holds(advice_on(report, {}), "no light is above 0"));
  report.luminance.lit_area = 1e-6;
  EXPECT_TRUE(advice_on(report, {}).empty());
}

TEST(Advice, AnExportSaysAndReportsIt) {
  const TempFolder folder;
  Shape triangles;
  for (int i = 0; i < 400; ++i) {
    const float x = 2 * float(i);
    triangles.positions.insert(triangles.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
    for (std::uint32_t k = 0; k < 3; ++k) triangles.indices.push_back(3 * std::uint32_t(i) + k);
  }
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 100;
  options.atlas_size = 64;
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  const auto report = export_world(lit_scene(triangles), options, {}, context);
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_GT(report->pages.size(), 64u);
  ASSERT_FALSE(said.empty());
  EXPECT_NE(said[0].find("400 charts on "), std::string::npos) << said[0];
  EXPECT_EQ(report->advice, said);
  ASSERT_TRUE(write_json(*report, folder / "report.json").ok());
  EXPECT_NE(TempFolder::read(folder / "report.json").find(said[0]), std::string::npos);
}

}  // namespace
}  // namespace atlas::test
