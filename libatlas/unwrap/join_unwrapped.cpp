#include "libatlas/unwrap/join_unwrapped.h"

#include <span>
#include <utility>
#include <vector>

#include "libatlas/charts/totals.h"

namespace atlas {
namespace {

void append_from(std::span<const std::uint32_t> values, std::size_t base,
                 std::vector<std::uint32_t>& to) {
  for (const std::uint32_t value : values) to.push_back(std::uint32_t(value + base));
}

void add(const ChartSet::Repairs& part, ChartSet::Repairs& sum) {
  sum.degenerate_triangles += part.degenerate_triangles;
  sum.duplicate_triangles += part.duplicate_triangles;
  sum.nonmanifold_edges += part.nonmanifold_edges;
  sum.nonmanifold_vertices += part.nonmanifold_vertices;
  sum.misoriented_edges += part.misoriented_edges;
  sum.split_charts += part.split_charts;
  sum.kept_charts += part.kept_charts;
  sum.reflattened_charts += part.reflattened_charts;
}

void append_charts(const ChartSet& part, std::size_t first_position, ChartSet& whole) {
  const std::size_t triangles = whole.triangle_chart.size(), charts = whole.charts.size(),
                    uvs = whole.uvs.size();
  append_from(part.triangle_chart, charts, whole.triangle_chart);
  append_from(part.chart_triangles, triangles, whole.chart_triangles);
  append_from(part.uv_vertex, first_position, whole.uv_vertex);
  append_from(part.triangle_uv, uvs, whole.triangle_uv);
  append_from(part.flipped_triangles, triangles, whole.flipped_triangles);
  whole.uvs.insert(whole.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (Chart chart : part.charts) {
    chart.first_triangle += std::uint32_t(triangles);
    chart.first_uv += std::uint32_t(uvs);
    whole.charts.push_back(chart);
  }
  whole.distortion = total_distortion(whole.charts);
  whole.seam_length += part.seam_length;
  whole.surface_area += part.surface_area;
  whole.copied_pieces += part.copied_pieces;
  add(part.repairs, whole.repairs);
  whole.noise.vertices += part.noise.vertices;
  whole.noise.peaks += part.noise.peaks;
  whole.timing.segmentation_cpu += part.timing.segmentation_cpu;
  whole.timing.parameterization_cpu += part.timing.parameterization_cpu;
}

}  // namespace

void append_unwrapped(UnwrappedMesh part, std::size_t first_position, UnwrappedMesh& whole) {
  const std::size_t charts = whole.charts.charts.size(), vertices = whole.vertices.size();
  append_from(part.vertices, first_position, whole.vertices);
  append_from(part.indices, vertices, whole.indices);
  append_from(part.triangle_page, 0, whole.triangle_page);
  whole.uvs.insert(whole.uvs.end(), part.uvs.begin(), part.uvs.end());
  for (ChartPlacement placement : part.placements) {
    placement.chart += std::uint32_t(charts);
    whole.placements.push_back(placement);
  }
  whole.thin_triangles += part.thin_triangles;
  whole.texels_drawn_twice += part.texels_drawn_twice;
  whole.gaps.charts += part.gaps.charts;
  whole.gaps.border += part.gaps.border;
  whole.gaps.near_before += part.gaps.near_before;
  whole.gaps.near_after += part.gaps.near_after;
  append_charts(part.charts, first_position, whole.charts);
}

}  // namespace atlas
