// Internal: whether a ChartSet that a caller passes is consistent, so that nothing is read or
// written beyond its arrays. Errors: bad_input; the messages start with `who`, such as "gaps".
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "libatlas/charts/charts.h"
#include "libatlas/core/status.h"

namespace atlas {

// Whether triangle_uv and chart_triangles are those of a mesh with so many indices.
Status check_chart_arrays(const ChartSet& charts, std::size_t indices, std::string_view who);

// Whether triangle_chart, which may be empty, names charts of the set, and flipped_triangles
// triangles of it. Linear.
Status check_triangle_lists(const ChartSet& charts, std::string_view who);

// Whether the ranges of a chart lie within such a set, and the uvs of its triangles within the
// chart's range; whether its uvs and its size are finite. `chart` is below charts.charts.size().
// Linear in the chart's triangles and uvs.
Status check_chart(const ChartSet& charts, std::size_t chart, std::string_view who);

// Whether a set as a whole is usable with the mesh: its arrays, its charts, the vertices of its
// uvs, its lists of triangles, and the mesh's materials and densities. Linear.
Status check_chart_set(const MeshView& mesh, const ChartSet& charts, std::string_view who);

}  // namespace atlas
