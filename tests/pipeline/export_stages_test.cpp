// What an export tells while it runs, and what of its options and scene reaches the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

ExportOptions small_pages(const std::filesystem::path& target) {
  ExportOptions options;
  options.target = target;
  options.atlases = 1;
  options.atlas_size = 64;
  options.simplify = options.measure_error = false;
  options.packing = PackPreset::fast;
  options.charts.min_fill = 0;
  return options;
}

TEST(ExportStages, EachBeginsAtZeroEndsAtOneAndIsToldOnce) {
  const TempFolder folder;
  struct Told {
    std::string stage;
    double first, last;
  };
  std::vector<Told> told;
  Context context;
  context.progress = [&](std::string_view stage, double fraction) {
    if (told.empty() || told.back().stage != stage)
      told.push_back({std::string(stage), fraction, fraction});
    EXPECT_GE(fraction, told.back().last) << stage;
    told.back().last = fraction;
  };
  std::vector<std::string> done;
  const auto stage_done = [&](const StageReport& stage) {
    EXPECT_GT(stage.peak_memory, 0);
    done.push_back(stage.stage);
  };
  ExportOptions options = small_pages(folder / "w.obj");
  options.simplify = options.measure_error = true;
  const auto report = export_world(lit_scene(grid(2, 2)), options, stage_done, context);
  ASSERT_TRUE(report.ok()) << report.status().message();
  std::vector<std::string> reported;
  for (const StageReport& stage : report->stages) reported.push_back(stage.stage);
  EXPECT_EQ(done, reported);
  std::vector<std::string> in_progress;
  for (const Told& t : told) {
    in_progress.push_back(t.stage);
    EXPECT_EQ(t.last, 1) << t.stage;
    // Images are written, and errors measured, while pages are baked.
    if (t.stage != "images" && t.stage != "error") {
      EXPECT_EQ(t.first, 0) << t.stage;
    }
  }
  EXPECT_EQ(in_progress, reported);
}

// With one thread, all pages but the last are written before that one is baked.
TEST(ExportStages, ImagesTellHowManyAreWrittenOnceAllPagesAreBaked) {
  const TempFolder folder;
  std::vector<double> images;
  double baking = 0;
  Context context;
  context.threads = 1;
  context.progress = [&](std::string_view stage, double fraction) {
    if (stage == "baking") baking = fraction;
    if (stage != "images") return;
    EXPECT_EQ(baking, 1);
    images.push_back(fraction);
  };
  ExportOptions options = small_pages(folder / "w.obj");
  options.atlases = 3;
  options.texel_metres = 0.01;
  options.threshold = 0;
  const auto scene = lit_scene(together(grid(4, 4), moved(grid(4, 4), 1, {2, 0, 0})));
  const auto report = export_world(scene, options, {}, context);
  ASSERT_TRUE(report.ok()) << report.status().message();
  const auto pages = double(report->pages.size());
  ASSERT_GE(pages, 2);
  ASSERT_GE(images.size(), 2u);
  EXPECT_EQ(images.front(), (pages - 1) / pages);
  EXPECT_EQ(images.back(), 1);
}

// What the plan skips is not among the stages that ran.
TEST(ExportStages, WhatIsSkippedDoesNotRun) {
  const TempFolder folder;
  for (const double threshold : {0.0, 2.0 / 255})
    for (const bool lit : {false, true}) {
      LoadedScene scene = lit_scene(grid(2, 2));
      if (!lit) scene.scene.illumination.clear();
      ExportOptions options = small_pages(folder / "w.obj");
      options.threshold = threshold;
      const auto report = export_world(scene, options, {}, {});
      ASSERT_TRUE(report.ok()) << report.status().message();
      bool sizing = false;
      for (const StageReport& stage : report->stages) {
        for (const PlanStep& step : report->plan.steps)
          EXPECT_TRUE(step.run || step.stage != stage.stage) << stage.stage;
        sizing |= stage.stage == "sizing";
      }
      EXPECT_EQ(sizing, lit && threshold == 0);
    }
}

// All that is left then is to give the files their names.
TEST(ExportStages, CancelledAfterTheLastByteWritesNothing) {
  const TempFolder folder;
  for (const char* name : {"w.obj", "w.wrl", "w.glb"}) {
    std::atomic<bool> cancel{false};
    Context context;
    context.cancel = &cancel;
    context.progress = [&](std::string_view stage, double fraction) {
      if (stage == "writing" && fraction == 1) cancel = true;
    };
    const auto report =
        export_world(lit_scene(grid(2, 2)), small_pages(folder / name), {}, context);
    EXPECT_EQ(report.status().code(), ErrorCode::cancelled) << name;
    EXPECT_EQ(folder.count(), 0u) << name;
  }
}

// A .glb holds its pages.
TEST(ExportStages, OnlyImagesBesideTheWorldAreNamed) {
  const TempFolder folder;
  for (const char* name : {"w.glb", "w.gltf"}) {
    const auto report = export_world(lit_scene(grid(2, 2)), small_pages(folder / name), {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    ASSERT_EQ(report->pages.size(), 1u);
    const bool beside = std::string(name) == "w.gltf";
    EXPECT_EQ(report->pages[0].image, beside ? "w_0.png" : "") << name;
    EXPECT_EQ(std::filesystem::exists(folder / "w_0.png"), beside);
    EXPECT_GT(report->pages[0].image_bytes, 0u);
  }
}

// Returns the height of the eye in a VRML world, in its units. It is the second coordinate: where z
// is up, the eye lies in a group that is turned.
double eye_height(const std::string& world) {
  const char* at = world.c_str() + world.find("position ") + 9;
  double height = 0;
  for (int k = 0; k < 2; ++k) {
    char* end = nullptr;
    height = std::strtod(at, &end);
    at = end;
  }
  return height;
}

// The room is 4 x 3 x 2.5 units, with z up. Eyes are 1.4 to 1.8 m above the floor.
TEST(ExportStages, TheEyeStandsOnTheFloorOfTheScene) {
  const TempFolder folder;
  ExportOptions options = small_pages(folder / "w.wrl");
  options.charts_only = true;
  options.up = Up::z;
  LoadedScene room = lit_room(4);
  for (const double metres_per_unit : {1.0, 0.8, 3.0}) {
    room.scene.metres_per_unit = metres_per_unit;
    ASSERT_TRUE(export_world(room, options, {}, {}).ok());
    const std::string world = TempFolder::read(folder / "w.wrl");
    EXPECT_NE(world.find("rotation 1 0 0 1.57"), std::string::npos) << "takes y to z";
    const double metres = metres_per_unit * eye_height(world);
    EXPECT_GE(metres, 1.4) << metres_per_unit;
    EXPECT_LE(metres, 1.8) << metres_per_unit;
  }
  options.up = Up::y;
  ASSERT_TRUE(export_world(room, options, {}, {}).ok());
  EXPECT_EQ(TempFolder::read(folder / "w.wrl").find("rotation 1 0 0 1.57"), std::string::npos);
}

TEST(ExportStages, GltfIsInMetres) {
  const TempFolder folder;
  LoadedScene sheet = lit_scene(grid(2, 2));
  sheet.scene.metres_per_unit = 2.5;
  ASSERT_TRUE(export_world(sheet, small_pages(folder / "w.glb"), {}, {}).ok());
  const auto back = read_scene(folder / "w.glb", {}, {});
  ASSERT_TRUE(back.ok()) << back.status().message();
  double low = 1e9, high = -1e9;
  for (const Vec3f& p : back->scene.positions) {
    low = std::min(low, back->scene.metres_per_unit * p.x);
    high = std::max(high, back->scene.metres_per_unit * p.x);
  }
  EXPECT_NEAR(high - low, 2.5, 1e-5);
}

// VRML holds floats, which have no room for metres at such an origin.
TEST(ExportStages, AnOriginThatIsLeftOutIsTold) {
  const TempFolder folder;
  LoadedScene sheet = lit_scene(grid(2, 2));
  sheet.scene.origin = {500000, 4000000, 0};
  const auto report = export_world(sheet, small_pages(folder / "w.wrl"), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_EQ(report->stages.back().quality, "relative to 500000 4000000 0");
}

// glTF holds it in doubles, but some engines do not.
TEST(ExportStages, AnOriginTooFarForSomeEnginesIsTold) {
  const TempFolder folder;
  LoadedScene sheet = lit_scene(grid(2, 2));
  for (const bool far : {false, true}) {
    if (far) sheet.scene.origin = {500000, 4000000, 0};
    for (const char* name : {"w.glb", "w.obj", "w.wrl"}) {
      const auto report = export_world(sheet, small_pages(folder / name), {}, {});
      ASSERT_TRUE(report.ok()) << report.status().message();
      const bool told =
          std::any_of(report->advice.begin(), report->advice.end(), [](const std::string& line) {
            return line.find("500000 4000000 0 by its node 'origin'") != std::string::npos;
          });
      EXPECT_EQ(told, far && std::string(name) == "w.glb") << name;
    }
  }
}

}  // namespace
}  // namespace atlas::test
