#include "libatlas/charts/chart_set_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "libatlas/core/is_finite.h"

namespace atlas {
namespace {

Status bad_input(std::string message) {
  return {ErrorCode::bad_input, std::move(message)};
}

Status check_vertices(const MeshView& mesh, const ChartSet& charts, std::string_view who) {
  if (charts.uv_vertex.size() != charts.uvs.size())
    return bad_input(fmt::format("{}: uvs and uv_vertex differ in size ({} and {})", who,
                                 charts.uvs.size(), charts.uv_vertex.size()));
  const auto beyond = [&](std::uint32_t v) { return v >= mesh.positions.size(); };
  const auto at = std::find_if(charts.uv_vertex.begin(), charts.uv_vertex.end(), beyond);
  if (at == charts.uv_vertex.end()) return {};
  return bad_input(
      fmt::format("{}: uv_vertex {} of {} positions", who, *at, mesh.positions.size()));
}

// Checks the arrays of the mesh that have one value per triangle, as make_charts() does.
Status check_values(const MeshView& mesh, std::string_view who) {
  const std::size_t triangles = mesh.indices.size() / 3;
  for (const auto& [name, count] : {std::pair("materials", mesh.materials.size()),
                                    std::pair("densities", mesh.density.size())}) {
    if (count != 0 && count != triangles)
      return bad_input(fmt::format("{}: {} {} for {} triangles (none, or 1 a triangle)", who, count,
                                   name, triangles));
  }
  for (std::size_t t = 0; t < mesh.density.size(); ++t) {
    if (!(mesh.density[t] > 0) || !std::isfinite(mesh.density[t]))
      return bad_input(fmt::format("{}: triangle {}: density {} (must be above 0 and finite)", who,
                                   t, mesh.density[t]));
  }
  return {};
}

}  // namespace

Status check_triangle_lists(const ChartSet& charts, std::string_view who) {
  const auto beyond = [&](const char* list, const std::vector<std::uint32_t>& ids,
                          std::size_t end) -> Status {
    const auto at =
        std::find_if(ids.begin(), ids.end(), [&](std::uint32_t id) { return id >= end; });
    if (at == ids.end()) return {};
    return bad_input(fmt::format("{}: {}[{}] is {}, of {}", who, list, at - ids.begin(), *at, end));
  };
  if (Status s = beyond("triangle_chart", charts.triangle_chart, charts.charts.size()); !s.ok())
    return s;
  return beyond("flipped_triangles", charts.flipped_triangles, charts.chart_triangles.size());
}

Status check_chart_arrays(const ChartSet& charts, std::size_t indices, std::string_view who) {
  if (charts.triangle_uv.size() == indices && 3 * charts.chart_triangles.size() == indices)
    return {};
  return bad_input(
      fmt::format("{}: the charts are not those of the mesh: {} triangle_uv and {} chart_triangles "
                  "for {} indices",
                  who, charts.triangle_uv.size(), charts.chart_triangles.size(), indices));
}

Status check_chart(const ChartSet& charts, std::size_t id, std::string_view who) {
  const Chart& chart = charts.charts[id];
  const std::size_t triangles = charts.chart_triangles.size();
  if (std::size_t{chart.first_triangle} + chart.triangle_count > triangles ||
      std::size_t{chart.first_uv} + chart.uv_count > charts.uvs.size())
    return bad_input(fmt::format("{}: chart {} reaches beyond the chart set", who, id));
  if (!(chart.size.x >= 0 && chart.size.y >= 0) || !is_finite(chart.size))
    return bad_input(
        fmt::format("{}: chart {} has a size of {} x {}", who, id, chart.size.x, chart.size.y));
  for (std::size_t uv = chart.first_uv, end = uv + chart.uv_count; uv < end; ++uv) {
    if (!is_finite(charts.uvs[uv]))
      return bad_input(fmt::format("{}: uv {} of chart {} is not finite", who, uv, id));
  }
  const std::uint32_t* const first = charts.chart_triangles.data() + chart.first_triangle;
  for (const std::uint32_t *t = first, *end = first + chart.triangle_count; t < end; ++t) {
    if (*t >= triangles)
      return bad_input(fmt::format("{}: chart {} lists triangle {}", who, id, *t));
    const std::uint32_t* const uvs = &charts.triangle_uv[3 * std::size_t{*t}];
    for (int k = 0; k < 3; ++k) {
      // Numbers below the first one wrap around, and are too large as well.
      if (uvs[k] - chart.first_uv >= chart.uv_count)
        return bad_input(
            fmt::format("{}: triangle {} uses uv {} outside chart {}", who, *t, uvs[k], id));
    }
  }
  return {};
}

Status check_chart_set(const MeshView& mesh, const ChartSet& charts, std::string_view who) {
  if (Status s = check_chart_arrays(charts, mesh.indices.size(), who); !s.ok()) return s;
  if (Status s = check_vertices(mesh, charts, who); !s.ok()) return s;
  if (Status s = check_values(mesh, who); !s.ok()) return s;
  if (Status s = check_triangle_lists(charts, who); !s.ok()) return s;
  std::size_t listed = 0;
  for (const Chart& chart : charts.charts) listed += chart.triangle_count;
  if (listed > charts.chart_triangles.size())
    return bad_input(fmt::format("{}: the charts list {} triangles of a mesh of {}", who, listed,
                                 charts.chart_triangles.size()));
  for (std::size_t c = 0; c < charts.charts.size(); ++c) {
    if (Status s = check_chart(charts, c, who); !s.ok()) return s;
  }
  return {};
}

}  // namespace atlas
