// Internal: the way from a mesh to flat charts; what it repeats is cut and flattened once.
#pragma once

#include <span>

#include "libatlas/charts/cut_pieces.h"

namespace atlas {

// Every triangle with area ends in one chart. Pieces that repeat others (find_copies) take their
// charts where they are a quarter of the mesh at least; what breaks a limit there is cut and
// flattened by itself. `density`: 1 a triangle, or empty.
CutCharts cut_into_charts(const Topology& topology, std::span<const float> density,
                          const ChartOptions& options, const Context& context);

}  // namespace atlas
