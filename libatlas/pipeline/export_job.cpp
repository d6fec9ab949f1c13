#include "libatlas/pipeline/export_job.h"

#include <string>
#include <utility>

#include "libatlas/pipeline/lightmap.h"
#include "libatlas/pipeline/plan.h"

namespace atlas {

ExportJob::ExportJob(const LoadedScene& loaded, const ExportOptions& asked,
                     const std::function<void(const StageReport&)>& stage_done,
                     const Context& given)
    : scene(loaded.scene),
      view(loaded.view),
      further_views(loaded.further_views),
      options(planned_options(loaded.scene, asked)),
      context(given),
      plan(make_plan(scene, options)),
      report(planned_report(loaded, plan, options)),
      record(report, stage_done, given) {
  if (std::string line = colours_text(scene, asked); !line.empty())
    report.advice.push_back(std::move(line));
}

MeshView view_of(const Scene& scene) {
  MeshView view;
  view.positions = scene.positions;
  view.indices = scene.indices;
  view.materials = scene.triangle_material;
  view.texcoords = scene.texcoords;
  view.texcoord_indices = scene.texcoord_indices;
  view.polygons = scene.polygons.polygon;
  return view;
}

void report_charts(const ChartSet& charts, ExportReport& report) {
  report.charts = charts.charts;
  report.distortion = charts.distortion;
  report.seam_length = charts.seam_length;
}

void report_making(const ChartSet& charts, ExportReport& report) {
  report.surface_area = charts.surface_area;
  report.repairs = charts.repairs;
  report.noise = charts.noise;
  report.chart_timing = charts.timing;
}

void report_placements(std::span<const ChartPlacement> placements, ExportReport& report) {
  for (const ChartPlacement& p : placements) {
    report.chart_pages.push_back(p.page);
    report.chart_densities.push_back((p.texels_per_unit.x + p.texels_per_unit.y) / 2);
  }
}

void report_plain_pages(std::span<const Extent> pages, std::span<const ChartPlacement> placements,
                        ExportReport& report) {
  for (const Extent& page : pages) report.pages.push_back({"", page.width, page.height, 0, 0});
  for (const ChartPlacement& p : placements) ++report.pages[std::size_t(p.page)].charts;
}

}  // namespace atlas
