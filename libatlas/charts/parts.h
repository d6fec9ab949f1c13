// Internal: turns a mesh into flat charts. Repeated pieces are cut and flattened only once.
#pragma once

#include <span>

#include "libatlas/charts/cut_pieces.h"

namespace atlas {

// Cuts a mesh into charts; every triangle with area ends up in one. Pieces that repeat others
// (find_copies) take their charts, if such pieces are at least a quarter of the mesh; those that
// would exceed a limit are cut and flattened by themselves. `density`: one per triangle, or empty.
CutCharts cut_into_charts(const Topology& topology, std::span<const float> density,
                          const ChartOptions& options, const Context& context);

}  // namespace atlas
