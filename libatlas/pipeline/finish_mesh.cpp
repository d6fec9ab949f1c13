#include "libatlas/pipeline/finish_mesh.h"

#include <utility>

#include "libatlas/pipeline/layout_options.h"
#include "libatlas/uvs/finish_uvs.h"
#include "libatlas/uvs/written_stretch.h"

namespace atlas {

FinishedMesh finish_mesh(const MeshToFinish& made, ExportReport& report, const Context& context) {
  FinishedMesh result{ChartedMesh(made.scene.indices, made.charts), {}, {}};
  result.mesh = made.coarse ? WorldMesh{made.coarse->indices, made.coarse->uv_indices,
                                        made.coarse->triangle_chart}
                            : result.fine.view();
  const PlacedCharts placed{made.charts, made.layout.placements, made.layout.pages};
  const std::int32_t mip_levels = report.mip_levels;
  FinishedUvs finished = finish_uvs(
      placed, result.mesh.uv_indices,
      {made.baked, mip_levels, made.baked ? gutter_pad(mip_levels) : plain_padding(made.options)},
      context);
  MeshView shape;
  shape.positions = made.scene.positions;
  const WrittenStretch written =
      measure_written(shape, placed, finished.uvs, made.options.charts.max_stretch, context);
  report.triangles_out = result.mesh.triangle_chart.size();
  report.thin_triangles = finished.thin_triangles;
  if (!made.baked) report.texels_drawn_twice = finished.texels_drawn_twice;
  report.written_stretch_999 = written.stretch_999;
  report.charts_beyond_bound = written.beyond;
  result.uvs = std::move(finished.uvs);
  return result;
}

}  // namespace atlas
