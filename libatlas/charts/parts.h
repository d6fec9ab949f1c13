// Internal: the way from a mesh to flat charts; what it repeats is cut and flattened once.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

struct CutCharts {
  std::vector<FlatChart> charts;    // ordered by first triangle
  std::uint64_t split_charts = 0;   // that failed and were cut into smaller ones, in all attempts
  std::uint64_t copied_pieces = 0;  // that took the charts of another piece
  ChartSet::Timing timing;          // segmentation_cpu, and the parts of both sums
};

// Every triangle with area ends in one chart. Pieces that repeat others (find_copies) take their
// charts where they are a quarter of the mesh at least; what breaks a limit there is cut and
// flattened by itself. `density`: 1 a triangle, or empty.
CutCharts cut_into_charts(const Topology& topology, std::span<const float> density,
                          const ChartOptions& options, const Context& context);

}  // namespace atlas
