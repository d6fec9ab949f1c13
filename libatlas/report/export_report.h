// The report of an export, which the JSON report is written from: what each stage did, what it
// cost, and how good its result is.
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
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/report/export_plan.h"
#include "libatlas/scene/defects.h"
#include "libatlas/texture/tone.h"
#include "libatlas/unwrap/like.h"

namespace atlas {

// The cost of one stage. size_in and size_out count items of the kind that the stage handles.
struct StageReport {
  std::string stage = {};
  double wall_seconds = 0, cpu_seconds = 0;
  std::int64_t peak_memory = 0;  // of the process until the end of the stage, bytes
  std::uint64_t size_in = 0, size_out = 0;
  std::string unit = {};     // what size_out counts, such as "charts"
  std::string quality = {};  // one phrase with the figure that matters
};

struct PageReport {
  std::string image = {};  // file name; empty without baked light, or if the target embeds images
  std::int32_t width = 0, height = 0;
  std::uint32_t charts = 0;
  std::uint64_t image_bytes = 0;
  // Of the image against the page before lossy compression, over all channels and texels, decibels;
  // empty if the image is lossless.
  std::optional<double> compression_psnr = {};
};

// Pictures for write_html(), which are made only if asked for (ExportOptions::report_pictures).
struct PagePicture {
  Image8 thumbnail = {};  // empty without an image
  Image8 charts =
      {};  // as large: at each pixel the number of the chart + 1 as 24 bits of RGB, or 0
};
struct ReportPictures {
  std::vector<PagePicture> pages = {};
  std::vector<Image8> worst = {};  // the surroundings of Fidelity::worst, which are in their middle
};

struct ExportReport {
  // Input
  std::filesystem::path scene = {}, target = {};
  std::uint64_t triangles = 0, vertices = 0, materials = 0, textures = 0, objects = 0;
  bool lit = false;
  double metres_per_unit = 1;
  Vec3d origin = {};
  DefectReport defects = {};
  ExportPlan plan = {};
  bool carried_out = false;  // if false, nothing below is known but the stages run so far
  std::vector<StageReport> stages = {};
  double wall_seconds = 0, cpu_seconds = 0;
  std::int64_t peak_memory = 0;

  // Charts
  std::vector<Chart> charts = {};
  // One per chart once they are packed: the page, and texels per scene unit (the mean of both
  // directions).
  std::vector<std::int32_t> chart_pages = {};
  std::vector<double> chart_densities = {};
  Distortion distortion = {};
  // The largest Distortion::stretch_999 of a chart with its uvs as floats, and the charts that
  // exceed ChartOptions::max_stretch only through that.
  double written_stretch_999 = 1;
  std::uint64_t charts_beyond_bound = 0;
  double seam_length = 0, surface_area = 0;  // scene units, scene units squared
  ChartSet::Repairs repairs = {};
  ChartSet::Noise noise = {};
  ChartSet::Timing chart_timing = {};

  // Light
  ToneMapping tone = {};
  double exposure_white = 0;  // scene luminance that becomes display white
  LuminanceStatistics luminance = {};
  double light_seam_length = 0;  // of creases at which the light jumps, scene units

  // Textures
  double texel = 0;         // the length asked for, scene units
  double packed_texel = 0;  // the mean length at the pages' scale, before halving, scene units
  std::int64_t full_texels = 0, final_texels = 0;
  std::uint64_t halved_charts = 0, uniform_charts = 0, unlit_charts = 0, capped_charts = 0,
                raised_charts = 0;
  std::uint64_t sampled_charts = 0;
  std::int64_t sampled_texels = 0;
  double downsizing_rms = 0, downsizing_max = 0;  // of display values, over sampled_texels

  // Pages
  GroupingResult grouping = {};
  double scale = 1;           // common to all textures
  double uv_utilization = 0;  // uv area of the charts / area of the pages
  // The share of the pages' texels that charts have only because of ExportOptions::min_side: what
  // they hold beyond the common scale. With baked light.
  double least_side_share = 0;
  bool outlines = false;
  std::vector<std::uint32_t> own_scales = {};  // as in PageLayout
  // Triangles written that rounding the uvs to floats turns over or leaves no area.
  std::uint64_t thin_triangles = 0;
  std::uint64_t cut_polygons = 0;  // faces that are written as triangles, since seams cut them
  // One per chart, or empty if no uvs of an earlier scene stay (ExportOptions::like).
  std::vector<ChartOrigin> origins = {};
  std::uint64_t opened_charts = 0;  // charts whose parts were moved apart so as not to share texels
  // The length of the charts' borders and of the parts that still share texels, in texels. Present
  // with baked light, and with uvs for a lightmap.
  std::optional<GapReport> gaps = {};
  std::optional<std::uint64_t> texels_drawn_twice = {};  // as in UnwrappedMesh; without baked light
  std::vector<PageReport> pages = {};
  int mip_levels = 0;           // lookups at levels 0..mip_levels read only a chart's own texels
  std::uint64_t gpu_bytes = 0;  // memory of the pages as RGBA8 with mip chains

  // The coarser mesh
  bool simplified = false;
  std::uint64_t triangles_out = 0;
  double slip_texels = 0, turn_degrees = 0;

  bool error_measured = false;
  Fidelity fidelity = {};
  // Files written: name, size in bytes.
  std::vector<std::pair<std::string, std::uint64_t>> files = {};
  // With keep_scene: what of the scene could not be written.
  std::vector<std::string> not_kept = {};
  ReportPictures pictures = {};
  std::vector<std::string> advice = {};  // what the figures mean for the user, and the remedy
};

// What was asked for, and what the report is to hold of it.
struct ReportRequest {
  std::string command = {};  // the command line, or what stands for it
  std::vector<std::pair<std::string, std::string>> options = {};  // with their values, as text
  bool chart_rows = false;  // in JSON, a row of figures for each chart, about 1 kB
};

// Writes the report as JSON (docs/report.md explains every key). The file is written completely or
// not at all. If the export was not carried out, the file has the plan and the stages so far, but
// no results.
Status write_json(const ExportReport& report, const std::filesystem::path& path,
                  const ReportRequest& request = {});

// Returns a line of text for users, such as the following. The seconds are CPU time.
//   charts  301709 -> 68 charts, L2 1.0012, 99.9 % 1.112  0.82 s  120 MiB
std::string stage_line(const StageReport& stage);

}  // namespace atlas
