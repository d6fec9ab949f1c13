// Advice on the length of texels, and on what it leaves of the light.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libatlas/pipeline/advice.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/advised.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// As if five metres were given where five millimetres were meant.
TEST(Advice, TexelsAsLongAsChartsAreNamed) {
  ExportReport report = report_of(16, 1, 16);
  ExportOptions options;
  EXPECT_TRUE(advice_on(report, options).empty());  // no texel size was given
  report.packed_texel = report.texel = options.texel_metres = 5;
  EXPECT_TRUE(
      holds(advice_on(report, options), "16 charts have 11 texels each on average, 5 m long"));
  EXPECT_TRUE(advice_on(report_of(2, 1, 16), options).empty());
}

// Texels that the pages could not hold are few because of the pages, not because of their length.
TEST(Advice, FewTexelsOfFullPagesAreNotCalledTooLong) {
  ExportReport report = report_of(16, 1, 16);
  report.packed_texel = 0.025;
  ExportOptions options;
  report.texel = options.texel_metres = 0.005;
  EXPECT_TRUE(holds(advice_on(report, options), "texels are 25 mm long"));
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
  report.metres_per_unit *= 100;
  options.texel_metres *= 100;
  EXPECT_TRUE(holds(advice_on(report, options), "texels are 2.5 m long, not the 500 mm of"));
  report.texel = 1.25;
  EXPECT_TRUE(advice_on(report, {}).empty());
}

// Least sides are worth a word only if they hold much of the pages, and can be lowered.
TEST(Advice, LeastSidesThatHoldMuchOfThePagesAreNamed) {
  ExportReport report = report_of(100, 8, 1024);
  report.packed_texel = 0.025;
  report.texel = 0.01;
  report.least_side_share = 0.1;
  const char* lower =
      "a larger ExportOptions::atlas_size or a lower ExportOptions::min_side, or a ";
  EXPECT_TRUE(holds(advice_on(report, {}), lower));
  EXPECT_TRUE(holds(advice_on(report, {.min_side = 1}),
                    "or a larger ExportOptions::atlas_size, or a longer"));
  report.least_side_share = 0.09;
  EXPECT_TRUE(holds(advice_on(report, {}), "or a larger ExportOptions::atlas_size, or a longer"));
}

// 100 plates of 2 m and 400 of 10 cm, which take 16 texels a side where 4 would be their share.
TEST(Advice, ALowerLeastSideIsNamedWhereItShortensTexels) {
  const TempFolder folder;
  Shape plates;
  for (int i = 0; i < 500; ++i) {
    const float side = i < 100 ? 2 : 0.1f, x = 3 * float(i % 25), y = 3 * float(i / 25);
    const auto first = std::uint32_t(plates.positions.size());
    plates.positions.insert(
        plates.positions.end(),
        {{x, y, 0}, {x + side, y, 0}, {x + side, y + side, 0}, {x, y + side, 0}});
    for (const std::uint32_t k : {0, 1, 2, 0, 2, 3}) plates.indices.push_back(first + k);
  }
  LoadedScene scene = lit_scene(plates);
  for (std::size_t v = 0; v < scene.scene.positions.size(); ++v)
    scene.scene.illumination[v] = v % 2 == 0 ? Vec3f{} : Vec3f{1, 1, 1};
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 1;
  options.atlas_size = 512;
  options.texel_metres = 0.005;
  double texel = 0;
  for (const std::int32_t side : {4, 16}) {
    options.min_side = side;
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    EXPECT_EQ(holds(report->advice, "or a lower ExportOptions::min_side"), side == 16);
    // 240 of the 256 texels of each small plate, and none of the large ones.
    const double held = 400 * (side * side - 16 * std::pow(0.025 / report->packed_texel, 2));
    EXPECT_NEAR(report->least_side_share, std::max(0.0, held / (512 * 512)), 0.02);
    if (side == 16) {
      EXPECT_GT(report->packed_texel, 1.5 * texel);
    }
    texel = report->packed_texel;
  }
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
  EXPECT_TRUE(holds(advice_on(report, {.target = "w.glb", .keep_scene = true}),
                    "(more ExportOptions::atlases or a larger"));
  EXPECT_TRUE(holds(advice_on(report, {.target = "w.obj", .keep_scene = true}),
                    "(a larger ExportOptions::atlas_size)"));  // its lightmap is one page
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

}  // namespace
}  // namespace atlas::test
