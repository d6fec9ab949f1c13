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

// Whether the ranges of a chart lie within such a set, and the uvs of its triangles within the
// chart's range. `chart` is below charts.charts.size(). Linear in the chart's triangles.
Status check_chart(const ChartSet& charts, std::size_t chart, std::string_view who);

// Whether a set as a whole is usable with the mesh: its arrays, its charts, the vertices of its
// uvs, and the mesh's materials and densities. Neither triangle_chart nor flipped_triangles is
// looked at. Linear.
Status check_chart_set(const MeshView& mesh, const ChartSet& charts, std::string_view who);

}  // namespace atlas
