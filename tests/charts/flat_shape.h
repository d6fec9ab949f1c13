// Internal: flat shapes as charts.
#pragma once

#include <numeric>

#include "libatlas/charts/flattening/flatten.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {

// Returns the chart of a flat shape with the shape's own coordinates.
inline FlatChart as_it_lies(const Shape& shape) {
  FlatChart chart;
  chart.triangles.resize(shape.triangle_count());
  std::iota(chart.triangles.begin(), chart.triangles.end(), 0u);
  for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
    const std::uint32_t* corner = &shape.indices[3 * t];
    chart.corners.push_back({corner[0], corner[1], corner[2]});
  }
  for (const Vec3f& p : shape.positions) chart.uvs.push_back({p.x, p.y});
  return chart;
}

}  // namespace atlas::test
