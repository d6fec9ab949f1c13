#include "libatlas/pipeline/finish_mesh.h"

#include <fmt/format.h>

#include <utility>

#include "libatlas/pipeline/layout_options.h"
#include "libatlas/uvs/finish_uvs.h"
#include "libatlas/uvs/written_stretch.h"

namespace atlas {

Result<FinishedMesh> finish_mesh(ExportJob& job, const PackedCharts& packed,
                                 const SimplifiedMesh* coarse) {
  const Context& context = job.record.begin("uvs");
  ExportReport& report = job.report;
  FinishedMesh result{ChartedMesh(job.scene.indices, packed.charts), {}, {}};
  result.mesh = coarse ? WorldMesh{coarse->indices, coarse->uv_indices, coarse->triangle_chart}
                       : result.fine.view();
  const PlacedCharts placed = packed.placed();
  const bool baked = job.plan.bake;
  const std::int32_t mip_levels = report.mip_levels;
  const std::int32_t padding = baked ? gutter_pad(mip_levels) : plain_padding(job.options);
  FinishedUvs finished =
      finish_uvs(placed, result.mesh.uv_indices, {baked, mip_levels, padding}, context);
  MeshView shape;
  shape.positions = job.scene.positions;
  const WrittenStretch written =
      measure_written(shape, placed, finished.uvs, job.options.charts.max_stretch, context);
  if (context.cancelled()) return Status::cancelled();
  report.triangles_out = result.mesh.triangle_chart.size();
  report.thin_triangles = finished.thin_triangles;
  if (!baked) report.texels_drawn_twice = finished.texels_drawn_twice;
  report.written_stretch_999 = written.stretch_999;
  report.charts_beyond_bound = written.beyond;
  result.uvs = std::move(finished.uvs);
  job.record.finish({packed.charts.uvs.size(), report.triangles_out, "triangles",
                     fmt::format("99.9 % {:.3f} as written", report.written_stretch_999)});
  return result;
}

}  // namespace atlas
