// Measures the shadow methods: frame times and their spread, and the error of each against a
// classic map of the same light.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/shadow/light_path.h"
#include "libatlas/view/image_error.h"
#include "libatlas/view/renderer.h"

namespace atlas {

struct BenchOptions {
  // Size, filter, interval and all other settings; shading and method are varied.
  RenderOptions render = {};
  Camera camera = {};
  double degrees_per_frame = 0.5;  // the light's speed along the path
  std::vector<Shading> shadings{Shading::lambert, Shading::blinn_phong, Shading::ward};
  std::vector<ShadowMethod> methods{std::begin(kAllMethods), std::end(kAllMethods)};
  double seconds = 0;  // least measured time of a combination; 0: `frames` decides
  int frames = 160;    // least number of measured frames of a combination
  int warm_up = 24;    // frames before those, not measured; at least two intervals are warmed up
  std::vector<int> error_intervals{2, 4, 8, 16, 32};
  int error_frames = 48;  // light positions at which errors are measured
};

// Times of one frame in seconds. `wall` ends when the frame is drawn, not when it is submitted.
// `cpu` is the CPU time of all threads of the process: on the software renderer it is the whole
// cost of the frame, whatever else the machine does. On a GPU that cost is `gpu_shadow` and
// `gpu_lit`, which the driver measures (NaN if it has not).
struct FrameTime {
  float wall = 0, cpu = 0, gpu_shadow = 0, gpu_lit = 0;
  double gpu() const { return double(gpu_shadow) + gpu_lit; }
  std::uint32_t triangles_shadow = 0, triangles_lit = 0;
};

struct Spread {
  double mean = 0, p50 = 0, p95 = 0, p99 = 0, p999 = 0, worst = 0;
};
Spread spread_of(std::vector<double> values);

struct BenchRun {
  Shading shading{};
  ShadowMethod method{};
  std::vector<FrameTime> frames = {};
  Spread wall = {}, cpu = {}, gpu = {};  // seconds per frame; gpu: 0 if nothing was measured
  double shadow_share = 0;               // of the GPU time
  double work_mean = 0, work_worst = 0;  // triangles submitted per frame, both passes
};

// Times of the same arithmetic, repeated beside the frames. Its spread comes from the machine
// (other programs, clock rates), so no frame times can be steadier.
struct BenchControl {
  // Their number is set so that they last about as long as a frame in the warm-up.
  std::uint64_t rounds = 0;
  Spread wall = {}, cpu = {};  // seconds
};

struct BenchTimes {
  std::vector<BenchRun> runs = {};
  BenchControl control = {};
};

struct BenchError {
  ShadowMethod method{};
  int interval = 0;  // k
  VisibilityError visibility = {};
  // Of the shaded pictures; psnr from the mean squared error of all of them.
  double psnr = 0, ssim = 0;
  // Seconds per frame while measuring visibility (same shader output); gpu: 0 if not measured.
  double cpu_median = 0, gpu_median = 0;
};

struct BenchResult {
  std::string device = {}, version = {};
  bool software = false;
  int width = 0, height = 0, map_resolution = 0, interval = 0, pcf = 0;
  double interval_degrees = 0;  // > 0: frames were timed with it, and not with `interval`
  std::uint32_t triangles = 0;
  BenchTimes times = {};
  std::vector<BenchError> errors = {};
};

// Runs every shading with every method. The combinations take turns frame by frame, so that a busy
// machine slows all of them alike and their ratios stay valid; the control takes its turn with
// them. Progress is that of the stage "times", and of "errors" below.
Result<BenchTimes> bench_times(const Renderer& first, const LightPath& path,
                               const BenchOptions& options, const Context& context = {});

// Measures the errors of every method except none and classic, for every interval in
// options.error_intervals.
Result<std::vector<BenchError>> bench_errors(const Renderer& first, const LightPath& path,
                                             const BenchOptions& options,
                                             const Context& context = {});

// Writes frames.csv, summary.json, summary.md, and plots.gp with its data: `gnuplot plots.gp` draws
// frames per second for each method (the paper's figures 2 to 5), the CPU time of every frame for
// each shading (the GPU's time if one was used), and error against that time.
Status write_bench(const BenchResult& result, const std::filesystem::path& folder);

// Returns the table of the summary in Markdown, for the terminal and for documents.
std::string bench_table(const BenchResult& result);

}  // namespace atlas
