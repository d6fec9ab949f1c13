// Tests the bench of the player: what it measures, and the files that it writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libatlas/view/bench.h"
#include "tests/view/play_folder.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

namespace fs = std::filesystem;

using Bench = Folder;

TEST_F(Bench, MeasuresEveryCombinationAndWritesItsFiles) {
  const View view = courtyard_view();
  BenchOptions o;
  o.render = small();
  o.render.schedule.interval_frames = 2;
  o.camera = view.camera;
  o.frames = 4;
  o.warm_up = 1;
  o.error_intervals = {2, 4};
  o.error_frames = 4;
  const Renderer first = must_render(view.scene, o.render);
  BenchResult r;
  r.device = test_context().info().renderer;
  r.software = test_context().info().software;
  const LightPath path = *LightPath::make({});
  std::atomic<bool> stop{true};
  Context stopped;
  stopped.cancel = &stop;
  EXPECT_EQ(bench_times(first, path, o, stopped).status().code(), ErrorCode::cancelled);
  EXPECT_EQ(bench_errors(first, path, o, stopped).status().code(), ErrorCode::cancelled);
  std::map<std::string, std::vector<double>, std::less<>> told;
  Context telling;
  telling.progress = [&](std::string_view stage, double f) {
    told[std::string(stage)].push_back(f);
  };
  r.times = bench_times(first, path, o, telling).value();
  r.errors = bench_errors(first, path, o, telling).value();
  EXPECT_EQ(told.size(), 2u);
  for (const auto& [stage, fractions] : told) {
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end())) << stage;
    EXPECT_GE(std::set(fractions.begin(), fractions.end()).size(), 4u) << stage;
    EXPECT_EQ(fractions.back(), 1) << stage;
  }
  EXPECT_EQ(r.times.runs.size(), 3u * 7u);
  EXPECT_EQ(r.errors.size(), 2u * 5u);
  for (const BenchRun& run : r.times.runs) {
    EXPECT_EQ(run.frames.size(), 4u);
    EXPECT_LE(run.cpu.p50, run.cpu.worst);
    std::vector<double> gpu;
    for (const FrameTime& f : run.frames) gpu.push_back(f.gpu());
    EXPECT_GT(run.gpu.p50, 0.0);
    EXPECT_EQ(run.gpu.worst, *std::max_element(gpu.begin(), gpu.end()));
    // The classic method submits every caster in every frame, `none` never does.
    const std::uint32_t casters = run.frames[0].triangles_shadow;
    if (run.method == ShadowMethod::classic) {
      EXPECT_EQ(casters, view.scene.triangle_count());
    }
    if (run.method == ShadowMethod::none) {
      EXPECT_EQ(casters, 0u);
    }
  }
  // Each round of the control does as much arithmetic as fits into a frame of the warm-up.
  EXPECT_GT(r.times.control.rounds, 0u);
  EXPECT_GT(r.times.control.cpu.p50, 0.0);
  EXPECT_LE(r.times.control.cpu.p50, 1.1 * r.times.control.wall.worst);
  EXPECT_NE(bench_table(r).find("| control | fixed arithmetic |"), std::string::npos);
  ASSERT_TRUE(write_bench(r, path_ / "out").ok());
  std::ifstream json_file(path_ / "out" / "summary.json");
  const nlohmann::json j = nlohmann::json::parse(json_file);
  EXPECT_EQ(j["runs"].size(), 21u);
  EXPECT_EQ(j["errors"].size(), 10u);
  EXPECT_EQ(j["control"]["rounds"], r.times.control.rounds);
  EXPECT_GE(j["runs"][0]["wall_ms"]["p95_over_p50"], 1.0);
  std::ifstream csv(path_ / "out" / "frames.csv");
  int lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 1 + 21 * 4);
  const std::string cost = r.software ? "cpu" : "gpu";
  for (const std::string& name : {std::string("plots.gp"), std::string("fps-march.dat"),
                                  cost + "-lambert.dat", cost + "-ward.dat"})
    EXPECT_TRUE(fs::exists(path_ / "out" / name)) << name;
}

TEST_F(Bench, SumsUpTheFramesOfARun) {
  const View view = courtyard_view();
  BenchOptions o;
  o.render = small();
  o.render.schedule.interval_frames = 3;
  o.camera = view.camera;
  o.shadings = {Shading::lambert};
  o.methods = {ShadowMethod::classic, ShadowMethod::linear};
  o.frames = 8;
  o.error_intervals = {4};
  const Renderer first = must_render(view.scene, o.render);
  const LightPath path = *LightPath::make({});
  const BenchTimes times = *bench_times(first, path, o);
  ASSERT_EQ(times.runs.size(), 2u);
  for (const BenchRun& run : times.runs) {
    double shadow = 0, gpu = 0, work = 0, worst = 0;
    for (const FrameTime& f : run.frames) {
      shadow += f.gpu_shadow;
      gpu += f.gpu();
      work += f.triangles_shadow + f.triangles_lit;
      worst = std::max(worst, double(f.triangles_shadow + f.triangles_lit));
    }
    EXPECT_NEAR(run.shadow_share, shadow / gpu, 1e-6);
    EXPECT_NEAR(run.work_mean, work / double(run.frames.size()), 1e-6);
    EXPECT_EQ(run.work_worst, worst);
  }
  EXPECT_GT(times.runs[1].work_worst, times.runs[1].work_mean) << "maps are drawn now and then";
  // Light positions come in whole intervals.
  std::vector<BenchError> errors;
  for (const int frames : {1, 4, 5, 8}) {
    o.error_frames = frames;
    const std::vector<BenchError> measured = *bench_errors(first, path, o);
    ASSERT_EQ(measured.size(), 1u) << "classic is the truth itself";
    errors.push_back(measured[0]);
  }
  for (const auto& [some, whole] : {std::pair{0, 1}, {2, 3}}) {
    EXPECT_EQ(errors[some].visibility.mean, errors[whole].visibility.mean);
    EXPECT_EQ(errors[some].psnr, errors[whole].psnr);
    EXPECT_GT(errors[some].visibility.mean, 0);
  }
}

// The errors once more, frame by frame.
TEST_F(Bench, ErrorsAreMeansOverTheLightsPositions) {
  const View view = courtyard_view();
  BenchOptions o;
  o.render = small();
  o.render.shading = Shading::lambert;
  o.camera = view.camera;
  o.methods = {ShadowMethod::linear};
  o.error_intervals = {4};
  o.error_frames = 8;
  const Renderer first = must_render(view.scene, o.render);
  const LightPath path = *LightPath::make({});
  const BenchError measured = (*bench_errors(first, path, o))[0];
  o.render.schedule.interval_frames = 4;
  o.render.schedule.interval_degrees = 0;
  std::vector<Renderer> renderers;  // the truth's visibility and colours, then those of the method
  for (const ShadowMethod method : {ShadowMethod::classic, ShadowMethod::linear})
    for (const bool visibility : {true, false}) {
      o.render.shadows = method;
      o.render.show_visibility = visibility;
      renderers.push_back(must_render(view.scene, o.render));
    }
  double mean = 0, wrong = 0, squares = 0, similarity = 0;
  for (int f = 0; f < 8; ++f) {
    std::vector<Image8> pictures;
    for (Renderer& r : renderers) {
      const auto ahead = [&](int n) { return path.direction((f + n) * o.degrees_per_frame); };
      ASSERT_TRUE(r.draw(o.camera, {ahead(0), ahead}).ok());
      pictures.push_back(r.read_image());
    }
    const VisibilityError e = visibility_error(pictures[2], pictures[0]);
    mean += e.mean / 8;
    wrong += e.wrong / 8;
    for (std::size_t i = 0; i < pictures[1].texels.size(); ++i)
      squares += std::pow((pictures[3].texels[i] - pictures[1].texels[i]) / 255.0, 2);
    similarity += ssim(pictures[3], pictures[1]) / 8;
  }
  EXPECT_NEAR(measured.visibility.mean, mean, 1e-9);
  EXPECT_NEAR(measured.visibility.wrong, wrong, 1e-9);
  EXPECT_NEAR(measured.ssim, similarity, 1e-9);
  squares /= 8.0 * 48 * 32 * 3;
  EXPECT_NEAR(measured.psnr, -10 * std::log10(squares), 1e-6);
  EXPECT_GT(squares, 0);
}

}  // namespace
}  // namespace atlas::testing
