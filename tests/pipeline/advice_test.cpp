#include "libatlas/pipeline/advice.h"

#include <gtest/gtest.h>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/pipeline/advised.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

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

TEST(Advice, KeptChartsThatLeaveThePageEmptyAreNamed) {
  ExportReport report;
  report.surface_area = 3;
  report.triangles = 300;
  report.repairs.kept_charts = 3;
  report.charts.resize(3);
  report.charts[2] = {.triangle_count = 128, .size = {31.6, 0.0316}, .kept = true};
  report.charts[2].distortion.surface_area = 1;
  report.pages.resize(1);
  report.uv_utilization = 0.006;
  ExportOptions options;
  EXPECT_TRUE(advice_on(report, options).empty());  // its uvs were not given
  options.charts.keep_uv_charts = true;
  EXPECT_TRUE(holds(advice_on(report, options), "charts fill only 0.6 % of the pages"));
  EXPECT_TRUE(holds(advice_on(report, options), "charts[2] of the report, of 128 triangles"));
  EXPECT_TRUE(holds(advice_on(report, options), "is 31.6 long and 0.0316 wide for 1 square"));
  report.uv_utilization = 0.2;
  EXPECT_TRUE(advice_on(report, options).empty());
  report.uv_utilization = 0.006;
  report.charts[2].kept = false;
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
  report.scale = 0.5;
  EXPECT_TRUE(
      holds(advice_on(report, {}), "16000 charts have 157 texels each on average, and 70 %"));
  report.scale = 1;  // they have no more light to show
  EXPECT_TRUE(advice_on(report, {}).empty());
  report = report_of(16, 8, 1024);  // few large charts in a long scene
  report.uv_utilization = 0.3;
  EXPECT_TRUE(advice_on(report, {}).empty());
}

TEST(Advice, LimitsThemselvesNeedNone) {
  ExportReport report = report_of(255, 1, 512);
  report.uv_utilization = 0.3;
  report.scale = 0.5;
  EXPECT_TRUE(advice_on(report, {}).empty());
  report.charts.resize(256);
  EXPECT_TRUE(holds(advice_on(report, {}), "256 charts have 307 texels each on average"));
  ExportOptions options;
  options.texel_metres = 0.005;
  report = report_of(100, 8, 1024);
  report.packed_texel = 0.01;
  EXPECT_TRUE(advice_on(report, options).empty());
}

TEST(Advice, PagesWithoutLightNeedNone) {
  ExportReport report = report_of(16000, 200, 64);
  EXPECT_FALSE(advice_on(report, {}).empty());
  report.gpu_bytes = 0;
  EXPECT_TRUE(advice_on(report, {}).empty());
}

// Of a texture that is not decoded, the kind of file tells whether it may have holes.
TEST(Advice, EncodedTexturesMayHaveHoles) {
  constexpr std::uint8_t kGrey = 0, kColour = 2, kPalette = 3, kGreyAlpha = 4, kColourAlpha = 6;
  Scene scene;
  scene.materials = {{.name = "leaf", .texture = 0, .alpha_mode = AlphaMode::mask}};
  scene.textures.resize(1);
  const auto is_open = [&](std::vector<std::uint8_t> bytes) {
    scene.textures[0].encoded = std::move(bytes);
    return !advice_on_materials(scene, Quantity::luminance).empty();
  };
  const auto png = [](std::uint8_t type) {
    std::vector<std::uint8_t> bytes(40, 0);
    bytes[0] = 0x89;
    bytes[25] = type;
    return bytes;
  };
  for (const std::uint8_t type : {kPalette, kGreyAlpha, kColourAlpha})
    EXPECT_TRUE(is_open(png(type))) << int{type};
  for (const std::uint8_t type : {kGrey, kColour}) EXPECT_FALSE(is_open(png(type))) << int{type};
  EXPECT_FALSE(is_open(std::vector<std::uint8_t>(40, 0xff))) << "JPEG";
  EXPECT_FALSE(is_open({0x89}));
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
  EXPECT_TRUE(holds(advice_on(report, options),
                    "missing, flipped, lie on each other or are squeezed to lines (leave"));
  options.charts.cone_degrees = 30;
  EXPECT_TRUE(holds(advice_on(report, options),
                    "lie on each other, bend beyond ChartOptions::cone_degrees or are squeezed to "
                    "lines (leave"));
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

// Colours on a part of a scene may be paint.
TEST(Advice, TrianglesWithoutTheLightOfOthersAreCounted) {
  const TempFolder folder;
  const std::string bare = "v 0 0 1\nv 1 0 1\nv 0 1 1\n", faces = "f 1 2 3\nf 4 5 6\nf 1 2 6\n";
  const auto advice = [&](const std::string& others, bool keep, bool charts_only) {
    const auto scene =
        read_scene(folder.write("s.obj", "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 2 2 2\n" + others),
                   {.keep_scene = keep}, {});
    EXPECT_TRUE(scene.ok()) << scene.status().message();
    ExportOptions options;
    options.target = folder / "w.obj";
    options.keep_scene = keep;
    options.charts_only = charts_only;
    const auto report = export_world(*scene, options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().message();
    return report.ok() ? report->advice : std::vector<std::string>{};
  };
  for (const bool keep : {false, true}) {
    EXPECT_TRUE(holds(advice(bare + faces, keep, false), "1 of 3 triangles have no light"));
    EXPECT_EQ(holds(advice(bare + faces, keep, false), "leaves the colours where they are"), keep);
    EXPECT_FALSE(holds(advice(bare + faces, keep, true), "no light"));
    // A triangle with light at one corner is not black.
    EXPECT_FALSE(holds(advice(bare + "f 1 2 3\nf 1 2 6\n", keep, false), "no light"));
    // Light that is 0 is none that is missing.
    const std::string dark = "v 0 0 1 0 0 0\nv 1 0 1 0 0 0\nv 0 1 1 0 0 0\n";
    EXPECT_FALSE(holds(advice(dark + faces, keep, false), "have no light"));
  }
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
  report.luminance.percentile98 = 700;
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
  report.luminance.log_average = report.luminance.percentile98 = 100;
  report.tone.scale = 1.0F / 90;
  report.exposure_white = 90;
  ExportOptions options;
  EXPECT_TRUE(advice_on(report, options).empty());
  options.tone.exposure_stops = 2;
  EXPECT_TRUE(holds(advice_on(report, options), "is shown white like all above 90"));
  report.luminance = {};
  EXPECT_TRUE(advice_on(report, options).empty());
}

// An OBJ whose vertices have colours of 0 to 255: white is 1, whatever the colours are.
TEST(Advice, ColoursBeyondOneAreNamed) {
  ExportReport report = report_of(100, 8, 1024);
  report.tone.scale = 1;
  report.exposure_white = 1;
  report.luminance.log_average = report.luminance.percentile98 = 140;
  ExportOptions options;
  options.quantity = Quantity::colour;
  EXPECT_TRUE(holds(advice_on(report, options), "colours of 140, the geometric mean"));
  EXPECT_TRUE(holds(advice_on(report, options), "divide those of 0 to 255 by 255"));
  options.tone.white = 100;  // given by hand, so they are known
  report.tone.scale = 0.01F;
  report.exposure_white = 100;
  EXPECT_TRUE(
      holds(advice_on(report, options), "light of 140, the geometric mean, is shown white"));
  options.tone.white = 0;
  report.tone.scale = 1;
  report.luminance.log_average = report.luminance.percentile98 = 0.7;
  EXPECT_TRUE(advice_on(report, options).empty());
}

// Rooms of 10 to 1000 lx beside a terrace in the sun.
TEST(Advice, RoomsThatTheMeasuredWhiteLeavesBlackAreNamed) {
  ExportReport report = report_of(100, 8, 1024);
  report.luminance.log_average = 900;
  report.luminance.percentile98 = report.exposure_white = 48000;
  report.tone.scale = 1 / 48000.0F;
  report.luminance.median = 100;
  EXPECT_TRUE(advice_on(report, {}).empty());
  report.luminance.median = 18;
  const std::string black = "more than half of what is seen is shown black: its median is 18, ";
  EXPECT_TRUE(holds(advice_on(report, {}), black + "and white begins at 4.8e+04"));
  EXPECT_TRUE(holds(advice_on(report, {}), "(ToneOptions::op reinhard-devlin shows dark rooms"));
  EXPECT_TRUE(holds(advice_on(report, {}), "ToneOptions::white 180 the dark alone)"));
  ExportOptions options;
  options.tone.white = 48000;
  EXPECT_TRUE(holds(advice_on(report, options), black));
  options.quantity = Quantity::colour;  // has no other white
  EXPECT_TRUE(advice_on(report, options).empty());
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
    options.packing = PackPreset::fast;
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    const bool strong = noise > 0.4;
    EXPECT_EQ(report->charts.size() > 25, strong) << report->charts.size();
    EXPECT_EQ(report->advice.empty(), !strong) << noise;
    EXPECT_EQ(holds(report->advice, "rough as by scan noise"), strong);
  }
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
