// What an export did, stage by stage, with the quality of each measured: the JSON report's content.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/bake/fidelity.h"
#include "libatlas/charts/charts.h"
#include "libatlas/charts/gaps.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/report/export_plan.h"
#include "libatlas/scene/defects.h"
#include "libatlas/texture/tone.h"

namespace atlas {

// One stage's cost. Sizes in and out are in the stage's own items.
struct StageReport {
  std::string stage;
  double wall_seconds = 0, cpu_seconds = 0;
  std::int64_t peak_memory = 0;  // of the process after the stage, bytes
  std::uint64_t size_in = 0, size_out = 0;
  std::string unit;     // of size_out: "charts"
  std::string quality;  // one phrase with the figure that matters
};

struct PageReport {
  std::string image;  // file name; empty without baked light
  std::int32_t width = 0, height = 0;
  std::uint32_t charts = 0;
  std::uint64_t image_bytes = 0;
};

struct ExportReport {
  // Input
  std::filesystem::path scene, target;
  std::uint64_t triangles = 0, vertices = 0, materials = 0, textures = 0, objects = 0;
  bool lit = false;
  double metres_per_unit = 1;
  Vec3d origin;
  DefectReport defects;
  ExportPlan plan;
  bool carried_out = false;  // else nothing below is known but the stages that have run
  std::vector<StageReport> stages;
  double wall_seconds = 0, cpu_seconds = 0;
  std::int64_t peak_memory = 0;

  // Charts
  std::vector<Chart> charts;
  Distortion distortion;
  double seam_length = 0, surface_area = 0;  // scene units, scene units squared
  ChartSet::Repairs repairs;
  ChartSet::Timing chart_timing;

  // Light
  ToneMapping tone;
  double exposure_white = 0;  // scene luminance that becomes display white
  LuminanceStatistics luminance;

  // Textures
  double texel = 0;  // asked for, scene units
  std::int64_t full_texels = 0, final_texels = 0;
  std::uint64_t halved_charts = 0, uniform_charts = 0, unlit_charts = 0, capped_charts = 0,
                raised_charts = 0;
  std::uint64_t sampled_charts = 0;
  std::int64_t sampled_texels = 0;
  double downsizing_rms = 0, downsizing_max = 0;  // display values, over sampled_texels

  // Pages
  GroupingResult grouping;
  double scale = 1;           // applied to all textures alike
  double utilization = 0;     // chart texels (boxes) or uv area (outlines) / page texels
  double uv_utilization = 0;  // uv area / page area
  bool outlines = false;
  std::uint64_t thin_triangles = 0;  // of those written: turned over or closed by uvs as floats
  std::uint64_t opened_charts = 0;   // parts of which were drawn apart, not to share texels
  // Where some still share them: texels of border. With baked light, and with uvs for a lightmap.
  std::optional<GapReport> gaps;
  std::optional<std::uint64_t> texels_drawn_twice;  // UnwrappedMesh has it; without baked light
  std::vector<PageReport> pages;
  std::uint64_t gpu_bytes = 0;  // RGBA8 with mip chains

  // The coarser mesh
  bool simplified = false;
  std::uint64_t triangles_out = 0;
  double slip_texels = 0, turn_degrees = 0;

  bool error_measured = false;
  Fidelity fidelity;
  std::vector<std::pair<std::string, std::uint64_t>> files;  // written: name, bytes
  std::vector<std::string> not_kept;  // with keep_scene: what of the scene was not written
  std::vector<std::string> advice;    // what the figures mean for the user, and the remedy
};

// Writes the report as JSON (docs/report.md names every key), whole or not at all. Of an export
// that was not carried out there is the plan, and nothing of what it would have given.
Status write_json(const ExportReport& report, const std::filesystem::path& path);

// One line for people: "charts  301709 -> 68 charts, L2 1.0012, 99.9 % 1.112  0.82 s  120 MiB", CPU
// seconds.
std::string stage_line(const StageReport& stage);

}  // namespace atlas
