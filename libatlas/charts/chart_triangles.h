// Internal: the triangles of one chart.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

inline std::span<const std::uint32_t> triangles_of(const ChartSet& charts, const Chart& chart) {
  return std::span(charts.chart_triangles).subspan(chart.first_triangle, chart.triangle_count);
}

// Returns a triangle's uvs in the order of its corners, beginning with the lowest. What is computed
// from them does not depend on which corner the input names first.
inline std::array<std::uint32_t, 3> from_lowest(std::array<std::uint32_t, 3> uvs) {
  std::rotate(uvs.begin(), std::min_element(uvs.begin(), uvs.end()), uvs.end());
  return uvs;
}

}  // namespace atlas
