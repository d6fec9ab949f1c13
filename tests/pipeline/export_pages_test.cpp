// The files of baked pages: what the report says of them, and that every option of baking shows in
// them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

ExportOptions full_pages(const TempFolder& folder) {
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 3;
  options.atlas_size = 64;
  options.texel_metres = 0.01;  // more texels than the pages hold
  options.threshold = 0;
  options.simplify = false;
  options.measure_error = false;
  return options;
}

LoadedScene two_sheets() {
  return lit_scene(together(grid(4, 4), moved(grid(4, 4), 1, {2, 0, 0})));
}

ExportReport exported(const LoadedScene& scene, const ExportOptions& options,
                      const Context& context = {}) {
  auto report = export_world(scene, options, {}, context);
  EXPECT_TRUE(report.ok()) << report.status().message();
  return report.ok() ? std::move(*report) : ExportReport{};
}

const StageReport& stage_of(const ExportReport& report, std::string_view name) {
  for (const StageReport& stage : report.stages)
    if (stage.stage == name) return stage;
  ADD_FAILURE() << "no stage " << name;
  return report.stages[0];
}

// Five squares of one size need the room of nine; small pieces of them do not.
TEST(ExportPages, PlatesThatLeaveThePageHalfEmptyAreCut) {
  const TempFolder folder;
  ExportOptions options = full_pages(folder);
  options.atlases = 1;
  options.atlas_size = 512;
  Shape plates;
  for (int i = 0; i < 5; ++i) plates = together(plates, moved(grid(24, 24), 1, {0, 2.0 * i, 0}));
  options.texel_metres = 1.0 / 240;  // no plate is longer than half a page
  const ExportReport report = exported(lit_scene(plates), options);
  EXPECT_GT(report.charts.size(), 5u);
  EXPECT_GT(report.uv_utilization, 0.65);
}

// A grey of a scan, whose file says 128, is a grey of 128 on the page.
TEST(ExportPages, ColoursAreShownAsTheyAre) {
  for (const float white : {0.0f, 2.0f}) {
    const TempFolder folder;
    ExportOptions options = full_pages(folder);
    options.quantity = Quantity::colour;
    options.tone.white = white;
    LoadedScene scan = two_sheets();
    scan.scene.illumination.assign(scan.scene.positions.size(), {0.2158605f, 1, 0});
    scan.scene.materials[0].diffuse = {0.5f, 0.5f, 0.5f};  // not applied
    exported(scan, options);
    const auto page = read_image8(folder / "world_0.png");
    ASSERT_TRUE(page.ok()) << page.status().message();
    const std::uint8_t* texel = page->at(page->width / 3, page->height / 3);
    EXPECT_EQ(int(texel[0]), white > 0 ? 92 : 128);
    EXPECT_EQ(int(texel[1]), white > 0 ? 188 : 255);
    EXPECT_EQ(int(texel[2]), 0);
  }
}

TEST(ExportPages, TheReportIsThatOfTheFiles) {
  const TempFolder folder;
  ExportOptions options = full_pages(folder);
  options.exr = true;
  const ExportReport report = exported(two_sheets(), options);
  ASSERT_GE(report.pages.size(), 2u);
  std::uint64_t texels = 0, with_mip_levels = 0, bytes = 0, charts = 0;
  for (const PageReport& page : report.pages) {
    const auto image = read_image8(folder / page.image);
    ASSERT_TRUE(image.ok()) << image.status().message();
    EXPECT_EQ(image->width, page.width);
    EXPECT_EQ(image->height, page.height);
    EXPECT_EQ(page.image_bytes, fs::file_size(folder / page.image));
    texels += std::uint64_t(page.width) * std::uint64_t(page.height);
    for (int w = page.width, h = page.height; w > 0 || h > 0; w /= 2, h /= 2)
      with_mip_levels += std::uint64_t(std::max(w, 1)) * std::uint64_t(std::max(h, 1));
    bytes += page.image_bytes;
    charts += page.charts;
  }
  EXPECT_EQ(charts, report.charts.size());
  EXPECT_NEAR(double(report.gpu_bytes), 4 * double(with_mip_levels), 16 * double(charts));
  EXPECT_EQ(stage_of(report, "images").size_out, bytes);
  // The texels of charts, of whose pages no other texels but gutters are covered.
  const std::uint64_t covered = stage_of(report, "baking").size_out;
  EXPECT_GE(double(covered), report.uv_utilization * double(texels));
  EXPECT_LE(covered, texels);
  std::map<std::string, std::uint64_t> on_disk;
  for (const auto& file : fs::directory_iterator(folder.path()))
    on_disk[file.path().filename().string()] = file.file_size();
  EXPECT_EQ((std::map<std::string, std::uint64_t>(report.files.begin(), report.files.end())),
            on_disk);
}

// Both are written from the same light.
TEST(ExportPages, AnExrShownByTheToneCurveIsThePng) {
  const TempFolder folder;
  ExportOptions options = full_pages(folder);
  options.atlases = 1;
  options.exr = true;
  options.bake_method = BakeMethod::average;
  const ExportReport report = exported(two_sheets(), options);
  const auto png = read_image8(folder / "world_0.png");
  const auto exr = read_image_float(folder / "world_0.exr");
  ASSERT_TRUE(png.ok() && exr.ok()) << exr.status().message();
  ASSERT_EQ(exr->width, png->width);
  ASSERT_EQ(exr->height, png->height);
  ASSERT_EQ(exr->channels, 3);
  int near = 0, all = 0;
  for (int y = 0; y < png->height; ++y) {
    for (int x = 0; x < png->width; ++x) {
      const float* l = exr->at(x, y);
      const Vec3f shown = report.tone.display({l[0], l[1], l[2]});
      near += std::fabs(255 * shown.x - float(png->at(x, y)[0])) <= 2;
      ++all;
    }
  }
  EXPECT_GT(near, 0.98 * all);
}

TEST(ExportPages, OptionsOfBakingShowInThem) {
  const TempFolder folder;
  const LoadedScene scene = two_sheets();
  const auto page = [&](auto change) {
    ExportOptions options = full_pages(folder);
    change(options);
    exported(scene, options);
    return TempFolder::read(folder / "world_0.png");
  };
  const std::string usual = page([](ExportOptions&) {});
  EXPECT_NE(page([](ExportOptions& o) { o.shifts = 1; }), usual);
  EXPECT_NE(page([](ExportOptions& o) { o.bake_method = BakeMethod::average; }), usual);
  const std::string raw = page([](ExportOptions& o) { o.png_compression = 0; });
  EXPECT_GT(raw.size(), usual.size());
  EXPECT_EQ(page([](ExportOptions&) {}), usual);
}

// A sheet and the gutters that four mip levels need take a whole page.
TEST(ExportPages, GuttersAreFilledForAllMipLevels) {
  const TempFolder folder;
  ExportOptions options = full_pages(folder);
  options.atlases = 1;
  options.mip_levels = 4;
  options.charts.min_fill = 0;
  exported(lit_scene(grid(4, 4)), options);
  const auto image = read_image8(folder / "world_0.png");
  ASSERT_TRUE(image.ok());
  ASSERT_EQ(image->width, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) ASSERT_GT(image->at(x, y)[0], 0) << x << ' ' << y;
}

TEST(ExportPages, AreTheSameForAnyNumberOfThreads) {
  const LoadedScene scene = two_sheets();
  std::map<std::string, std::string> one;
  for (const int threads : {1, 2, 5}) {
    const TempFolder folder;
    ExportOptions options = full_pages(folder);
    options.exr = true;
    Context context;
    context.threads = threads;
    exported(scene, options, context);
    std::map<std::string, std::string> files;
    for (const auto& file : fs::directory_iterator(folder.path()))
      files[file.path().filename().string()] = TempFolder::read(file.path());
    if (one.empty()) one = files;
    EXPECT_GE(files.size(), 5u);
    EXPECT_EQ(files, one) << threads;
  }
}

// Baking reports after each chart, of whichever page, and ends at 1 with the last one.
TEST(ExportPages, ProgressOfBakingIsThatOfAllPages) {
  const TempFolder folder;
  std::set<double> reported;
  Context context;
  context.threads = 1;
  context.progress = [&](std::string_view stage, double fraction) {
    if (stage == "baking") reported.insert(fraction);
  };
  const ExportReport report = exported(two_sheets(), full_pages(folder), context);
  ASSERT_GE(report.pages.size(), 2u);
  reported.erase(0);
  EXPECT_GE(reported.size(), report.charts.size());
  EXPECT_LE(*reported.begin(), 1.0 / double(report.pages.size()));
  EXPECT_EQ(*reported.rbegin(), 1);
}

TEST(ExportPages, ErrorsAreMeasuredOnlyIfAskedFor) {
  const TempFolder folder;
  ExportOptions options = full_pages(folder);
  for (const bool asked : {false, true}) {
    options.measure_error = asked;
    const ExportReport report = exported(two_sheets(), options);
    EXPECT_EQ(report.error_measured, asked);
    const bool staged = std::any_of(report.stages.begin(), report.stages.end(),
                                    [](const StageReport& s) { return s.stage == "error"; });
    EXPECT_EQ(staged, asked);
    EXPECT_EQ(report.fidelity.lit > 0, asked);
  }
}

TEST(ExportPages, TheLineOfDownsizingHasTheFiguresOfTheReport) {
  const TempFolder folder;
  ExportOptions options = full_pages(folder);
  options.atlas_size = 512;
  options.threshold = 2.0 / 255;
  const ExportReport report = exported(two_sheets(), options);
  EXPECT_GT(report.halved_charts, 0u);
  EXPECT_GT(report.sampled_charts, 0u);
  EXPECT_LT(report.final_texels, report.full_texels);
  const StageReport& stage = stage_of(report, "downsizing");
  EXPECT_EQ(stage.size_in, std::uint64_t(report.full_texels));
  EXPECT_EQ(stage.size_out, std::uint64_t(report.final_texels));
  EXPECT_EQ(stage.quality,
            fmt::format("{} charts halved, {} unlit, rms {:.5f} ({} sampled)", report.halved_charts,
                        report.unlit_charts, report.downsizing_rms, report.sampled_charts));
}

// Even light shrinks the textures of a ball. With textures of full size, each of its triangles is
// needed, and so it is with small ones.
TEST(ExportPages, SmallTexturesLetTheSurfaceSlipNoFurther) {
  const TempFolder folder;
  LoadedScene ball = lit_scene(icosphere(3));
  ball.scene.illumination.assign(ball.scene.positions.size(), Vec3f{1, 1, 1});
  ExportOptions options = full_pages(folder);
  options.atlas_size = 512;
  options.texel_metres = 0.02;
  options.threshold = 2.0 / 255;
  options.simplify = true;
  options.charts.preset = ChartPreset::fast;
  const ExportReport report = exported(ball, options);
  EXPECT_LT(report.final_texels, report.full_texels / 4);
  EXPECT_GE(report.triangles_out, 1200u);
  options.simplify_slip = 2;
  EXPECT_LT(exported(ball, options).triangles_out, 1000u);
}

}  // namespace
}  // namespace atlas::test
