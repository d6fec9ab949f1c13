// Internal: the way from pieces of a mesh to flat charts.
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

// Appends charts; they are in no order then.
void append(CutCharts part, CutCharts& whole);
void sort_by_triangle(std::vector<FlatChart>& charts);

// Segments and flattens these pieces (ascending) of a mesh; of the mesh's frames none are used.
// Pieces of large meshes are cut so many triangles at a time, and in parallel: pieces know nothing
// of each other, 10^5 of them would need much memory at once, and parts that fit the processor's
// caches are faster. The result does not depend on the number of threads. Incomplete if cancelled.
CutCharts cut_pieces(const FlattenInput& mesh, std::span<const std::uint32_t> pieces,
                     const Context& context);

}  // namespace atlas
