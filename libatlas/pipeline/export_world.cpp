#include "libatlas/pipeline/export_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/advice.h"
#include "libatlas/pipeline/assemble_world.h"
#include "libatlas/pipeline/chart_stages.h"
#include "libatlas/pipeline/export_job.h"
#include "libatlas/pipeline/finish_mesh.h"
#include "libatlas/pipeline/mesh_uvs.h"
#include "libatlas/pipeline/pack_stages.h"
#include "libatlas/pipeline/page_stages.h"
#include "libatlas/pipeline/plan.h"
#include "libatlas/pipeline/write_export.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/uv_page.h"

namespace atlas {
namespace {

// Finds errors that would otherwise show only after minutes.
Status check_job(const ExportJob& job) {
  if (Status s = check_plan(job.plan, job.options); !s.ok()) return s;
  if (!job.plan.bake) return {};
  if (job.options.quantity == Quantity::illuminance) {
    if (Status s = check_images(job.scene); !s.ok()) return s;
  }
  return job.options.exr ? check_image_module(job.options.target.string()) : Status();
}

Result<PackedCharts> make_and_pack(ExportJob& job, const SceneLight* light) {
  Result<ChartSet> charts = cut_charts(job, light);
  if (!charts.ok()) return charts.status();
  if (!light) return pack_plain(job, std::move(*charts));
  if (Status s = cut_long_charts(job, *light, *charts); !s.ok()) return s;
  Result<SizedCharts> sized = size_all_textures(job, *light, std::move(*charts));
  if (!sized.ok()) return sized.status();
  return pack_lit(job, std::move(*sized));
}

Status run_stages(ExportJob& job) {
  if (job.options.mesh_uvs != MeshUvs::places) {
    const Result<MeshUvsOfScene> made = unwrap_meshes_once(job);
    return made.ok() ? write_export(job, *made) : made.status();
  }
  std::optional<SceneLight> light;
  if (job.plan.bake) {
    Result<SceneLight> exposed = expose(job);
    if (!exposed.ok()) return exposed.status();
    light = std::move(*exposed);
  }
  const SceneLight* lit = light ? &*light : nullptr;
  const Result<PackedCharts> packed = make_and_pack(job, lit);
  if (!packed.ok()) return packed.status();
  BakedPages baked;
  if (lit) {
    Result<BakedPages> pages = bake(job, *lit, *packed);
    if (!pages.ok()) return pages.status();
    baked = std::move(*pages);
  }
  std::optional<SimplifiedMesh> coarse;
  if (job.plan.simplify) {
    Result<SimplifiedMesh> simplified = simplify(job, *packed);
    if (!simplified.ok()) return simplified.status();
    coarse = std::move(*simplified);
  }
  Result<FinishedMesh> finished = finish_mesh(job, *packed, coarse ? &*coarse : nullptr);
  if (!finished.ok()) return finished.status();
  return write_export(job, {lit, *packed, baked, finished->mesh, std::move(finished->uvs)});
}

void advise(ExportJob& job) {
  ExportReport& report = job.report;
  const auto add = [&](std::vector<std::string> lines) {
    std::move(lines.begin(), lines.end(), std::back_inserter(report.advice));
  };
  add(advice_on(report, job.options));
  if (job.plan.bake) {
    add(advice_on_missing_light(job.scene, report.defects, job.options));
    if (!job.options.keep_scene) add(advice_on_materials(job.scene, job.options.quantity));
  }
  if (report.cut_polygons > 0)
    report.advice.push_back(
        fmt::format("{} of {} faces do not lie flat in one piece, and are written as triangles",
                    report.cut_polygons, job.scene.polygons.count()));
  if (report.thin_triangles > 0)
    report.advice.push_back(thin_triangles_text(report.thin_triangles, report.triangles_out));
  for (const std::string& line : report.advice) job.context.say(line);
}

}  // namespace

std::string plain_pages_text(std::span<const Extent> pages, bool udim) {
  const auto wider = [](const Extent& a, const Extent& b) { return a.width < b.width; };
  const auto [least, most] = std::minmax_element(pages.begin(), pages.end(), wider);
  // Pages of a given density are no larger than what is on them.
  const std::string sides =
      fmt::format("{0} x {0}", most->width) +
      (least->width < most->width ? fmt::format(" to {0} x {0}", least->width) : std::string());
  if (pages.size() > 1 && udim)
    return fmt::format("uvs of UDIM tiles 1001 to {}, packed for {} texels each",
                       1000 + pages.size(), sides);
  if (pages.size() > 1)
    return fmt::format("uvs of {} square pages, packed for {} texels", pages.size(), sides);
  return uv_page_text(pages[0].width, pages[0].height);
}

Result<ExportReport> export_world(const LoadedScene& loaded, const ExportOptions& options,
                                  const std::function<void(const StageReport&)>& stage_done,
                                  const Context& context) {
  if (Status s = check_options(options); !s.ok()) return s;
  if (Status s = check_scene(loaded.scene); !s.ok()) return s;
  ExportJob job(loaded, options, stage_done, context);
  const double cpu = own_cpu_seconds(), wall = wall_seconds();
  if (Status s = check_job(job); !s.ok()) return s;
  if (Status s = run_stages(job); !s.ok()) return s;
  job.report.carried_out = true;
  advise(job);
  job.report.cpu_seconds = own_cpu_seconds() - cpu;
  job.report.wall_seconds = wall_seconds() - wall;
  job.report.peak_memory = peak_memory();
  return std::move(job.report);
}

}  // namespace atlas
