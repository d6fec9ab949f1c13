// Internal: the triangles of one chart.
#pragma once

#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

inline std::span<const std::uint32_t> triangles_of(const ChartSet& charts, const Chart& chart) {
  return std::span(charts.chart_triangles).subspan(chart.first_triangle, chart.triangle_count);
}

}  // namespace atlas
