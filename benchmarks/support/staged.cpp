#include "benchmarks/support/staged.h"

#include "libatlas/pipeline/plan.h"
#include "libatlas/uvs/placement.h"

namespace atlas::bench {

Staged::Staged(std::string work, LoadedScene scene, const Context& run_context)
    : name(std::move(work)), loaded(std::move(scene)), context(run_context) {}

MeshView Staged::view() const {
  MeshView view;
  view.positions = scene().positions;
  view.indices = scene().indices;
  view.materials = scene().triangle_material;
  view.texcoords = scene().texcoords;
  view.texcoord_indices = scene().texcoord_indices;
  return view;
}

double Staged::texel() const {
  if (settings.texel > 0) return settings.texel;
  ExportOptions options;
  options.atlases = settings.pages;
  options.atlas_size = settings.page_size;
  return make_plan(scene(), options).texel_metres / scene().metres_per_unit;
}

Status Staged::need_charts() {
  if (charts) return {};
  Result<ChartSet> made = make_charts(view(), {}, context);
  if (made.ok()) charts = std::move(*made);
  return made.status();
}

Status Staged::need_light() {
  if (tone) return {};
  if (!scene().lit()) return {ErrorCode::bad_input, name + ": has no light to bake"};
  sampler.emplace(scene(), Quantity::illuminance);
  Result<LuminanceStatistics> statistics = measure_luminance(*sampler, context);
  if (!statistics.ok()) return statistics.status();
  Result<ToneMapping> made = make_tone_mapping({}, *statistics);
  if (made.ok()) tone = *made;
  return made.status();
}

Status Staged::need_textures() {
  if (textures) return {};
  for (const Status& status : {need_charts(), need_light()})
    if (!status.ok()) return status;
  TextureOptions options;
  options.texel = texel();
  options.threshold = settings.threshold;
  options.max_side = settings.page_size - 2 * gutter_pad(2);
  Result<TextureResult> made = size_chart_textures(light(), options, context);
  if (made.ok()) textures = std::move(*made);
  return made.status();
}

Status Staged::need_layout() {
  if (layout) return {};
  if (const Status status = need_textures(); !status.ok()) return status;
  LayoutOptions options;
  options.alignment = 4;
  options.pages = settings.pages;
  options.page_size = settings.page_size;
  options.padding = gutter_pad(2);
  options.outlines = true;
  Result<PageLayout> made = lay_out_pages(*charts, densities(), options, context);
  if (made.ok()) layout = std::move(*made);
  return made.status();
}

std::vector<Vec2d> Staged::densities() const {
  std::vector<Vec2d> result;
  for (const ChartTexture& t : textures->charts) result.push_back(t.texels_per_unit);
  return result;
}

Row Staged::row(const std::string& stage, const std::string& setting, bool preset) const {
  Row row;
  row.stage = stage;
  row.mesh = name;
  row.setting = setting;
  row.preset = preset;
  row.threads = threads;
  row.triangles = row.size_in = scene().triangle_count();
  return row;
}

void StageRun::measured(Row& row, const std::function<Status()>& work) const {
  in_own_process(row, done, [&](const TakeRow& take) {
    measure(repeats, row, work);
    take(row);
  });
}

void report_failure(const StageRun& run, const std::string& stage, const Status& status) {
  Row row = run.staged.row(stage, "standard", true);
  row.failure = status.message();
  run.done(row);
}

}  // namespace atlas::bench
