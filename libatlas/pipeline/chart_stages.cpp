#include "libatlas/pipeline/chart_stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "libatlas/charts/tiles.h"
#include "libatlas/core/srgb.h"
#include "libatlas/pipeline/longest_sides.h"
#include "libatlas/pipeline/plan.h"
#include "libatlas/pipeline/size_textures.h"
#include "libatlas/pipeline/texture_gaps.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/texture/light_seams.h"

namespace atlas {
namespace {

LightSeams light_seams(const ExportJob& job, const SceneLight* light, const Context& context) {
  const ExportOptions& options = job.options;
  if (!light || !options.split_at_light || options.charts.keep_uv_charts) return {};
  const double metres = job.scene.metres_per_unit;
  const double room = double(options.atlases) * options.atlas_size * options.atlas_size;
  const double afforded = std::sqrt(job.plan.surface_area_m2 / room) / metres;
  LightSeamOptions seams;
  seams.texel = std::max(job.plan.texel_metres / metres, afforded);
  return find_light_seams(light->sampler, light->tone, seams, context);
}

// The edges that are seams in one list or the other; either may be empty.
std::vector<std::uint8_t> with_seams(const std::vector<std::uint8_t>& given,
                                     std::span<const std::uint8_t> found) {
  std::vector<std::uint8_t> edges(given);
  edges.resize(std::max(given.size(), found.size()), 0);
  for (std::size_t h = 0; h < found.size(); ++h) edges[h] |= found[h];
  return edges;
}

// Sets job.like, and what charts are made of, if uvs of an earlier scene stay.
Status find_what_stays(ExportJob& job, MeshView& mesh, ChartOptions& options,
                       const Context& context) {
  if (!job.options.like) return {};
  Result<LikeScene> like = like_scene(job.scene, mesh, job.options);
  if (!like.ok()) return like.status();
  if (!like->mesh->nothing().empty()) {
    context.say(like->mesh->nothing());
    job.report.advice.push_back(like->mesh->nothing());
    return {};
  }
  mesh = like->mesh->view();
  options = like->mesh->chart_options(options);
  job.like = std::move(*like);
  return {};
}

}  // namespace

Result<SceneLight> expose(ExportJob& job) {
  const Context& context = job.record.begin("exposure");
  SceneLight light{LuminanceSampler(job.scene, job.options.quantity), {}};
  Result<LuminanceStatistics> statistics = measure_luminance(light.sampler, context);
  if (!statistics.ok()) return statistics.status();
  Result<ToneMapping> tone = make_tone_mapping(tone_options(job.options), *statistics);
  if (!tone.ok()) return tone.status();
  light.tone = *tone;
  ExportReport& report = job.report;
  report.luminance = *statistics;
  report.tone = light.tone;
  report.exposure_white = double(light.tone.white) / light.tone.scale;
  const auto median = static_cast<float>(report.luminance.median);
  job.record.finish(
      {job.scene.triangle_count(), 1, "tone curve",
       fmt::format("white {:.4g}, the median {:.4g} shown as {} of 255", report.exposure_white,
                   median, quantize8(light.tone.display({median, median, median}).y))});
  return light;
}

Result<ChartSet> cut_charts(ExportJob& job, const SceneLight* light) {
  const Context& context = job.record.begin("charts");
  MeshView mesh = view_of(job.scene);
  const LightSeams seams = light_seams(job, light, context);
  if (context.cancelled()) return Status::cancelled();
  const std::vector<std::uint8_t> edges = with_seams(job.options.seams, seams.edges);
  mesh.seams = edges;
  ChartOptions options = job.options.charts;
  if (Status s = find_what_stays(job, mesh, options, context); !s.ok()) return s;
  Result<ChartSet> charts = make_charts(mesh, options, context);
  if (!charts.ok()) return charts;
  ExportReport& report = job.report;
  report_charts(*charts, report);
  report.light_seam_length = seams.length;
  report_making(*charts, report);
  std::string quality = fmt::format("L2 {:.4f}, 99.9 % {:.3f}", charts->distortion.stretch_l2,
                                    charts->distortion.stretch_999);
  if (job.options.charts.keep_uv_charts) {
    quality += fmt::format(", {} kept, {} reflattened", charts->repairs.kept_charts,
                           charts->repairs.reflattened_charts);
  }
  job.record.finish({job.scene.triangle_count(), charts->charts.size(), "charts", quality});
  return charts;
}

Status cut_long_charts(ExportJob& job, const SceneLight& light, ChartSet& charts) {
  const Context& context = job.record.begin("tiling");
  const TextureOptions texture = texture_options(job.plan, job.report, job.options);
  const Result<std::vector<double>> densities =
      wanted_densities({light.sampler, charts, light.tone}, texture, context);
  if (!densities.ok()) return densities.status();
  const std::size_t before = charts.charts.size();
  const std::vector<double> sides = longest_sides(charts, *densities, {texture, job.options});
  const Result<std::size_t> cut =
      cut_to_limits(view_of(job.scene), {sides, job.options.charts.max_stretch}, charts, context);
  if (!cut.ok()) return cut.status();
  report_charts(charts, job.report);
  job.record.finish(
      {before, charts.charts.size(), "charts", fmt::format("{} longer than half a page", *cut)});
  return {};
}

Result<SizedCharts> size_all_textures(ExportJob& job, const SceneLight& light, ChartSet charts) {
  const ExportOptions& options = job.options;
  // Without a threshold, textures get their sizes all the same, but none is halved.
  const bool downsizing = options.threshold > 0;
  const Context& context = job.record.begin(downsizing ? "downsizing" : "sizing");
  const TextureOptions texture = texture_options(job.plan, job.report, options);
  Result<SizedTextures> sized =
      size_textures({light.sampler, charts, light.tone}, {texture, options}, context);
  if (!sized.ok()) return sized.status();
  TextureResult& textures = sized->textures;
  const PagesOfCharts pages{view_of(job.scene), options.charts.max_stretch,
                            double(options.atlases) * options.atlas_size * options.atlas_size};
  const TexturesOfCharts opened{textures.charts, texture.max_side};
  job.report.opened_charts = open_texture_gaps(pages, opened, charts, context).charts;
  if (context.cancelled()) return Status::cancelled();
  report_charts(charts, job.report);
  SizedCharts result{std::move(charts), {}, {}, sized->sizing};
  for (const ChartTexture& t : textures.charts) {
    result.densities.push_back(t.texels_per_unit);
    result.full_densities.push_back(t.full_texels_per_unit);
  }
  job.report.texel = texture.texel;
  report_textures(textures, job.report);
  job.record.finish(
      {std::uint64_t(textures.full_texels), std::uint64_t(textures.final_texels), "texels",
       fmt::format("{} charts halved, {} unlit, rms {:.5f} ({} sampled)", textures.halved,
                   textures.unlit, textures.rms_error, textures.sampled)});
  return result;
}

}  // namespace atlas
