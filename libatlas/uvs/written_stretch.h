// Internal: how far charts are stretched once their uvs are floats.
#pragma once

#include <cstddef>
#include <span>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"
#include "libatlas/uvs/page_uvs.h"

namespace atlas {

struct WrittenStretch {
  double stretch_999 = 1;  // the largest Distortion::stretch_999 of a chart
  // Charts whose stretch the bound limits before rounding, but not after. Given charts
  // (Chart::kept) and those beyond the bound before are not counted. Nor is an excess of a
  // hundredth of what the bound leaves, with 10^-4, as dense meshes at the bound have it.
  std::size_t beyond = 0;
};

// Measures all charts of the mesh with these uvs, which are fractions of their pages, one per uv of
// the charts. Of the mesh, only positions and densities are used. Linear; the result is the same
// for every thread count. It is incomplete if cancelled.
WrittenStretch measure_written(const MeshView& mesh, const PlacedCharts& placed,
                               std::span<const Vec2f> uvs, double max_stretch,
                               const Context& context);

}  // namespace atlas
