// Internal: turns pieces of a mesh into flat charts.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

struct CutCharts {
  std::vector<FlatChart> charts;    // ordered by first triangle
  std::uint64_t split_charts = 0;   // charts that failed and were divided on the way to these
  std::uint64_t copied_pieces = 0;  // pieces that took the charts of another piece
  ChartSet::Timing timing;          // segmentation_cpu, and the parts of both sums
};

// Appends charts. They are not in order afterwards.
void append(CutCharts part, CutCharts& whole);
void sort_by_triangle(std::vector<FlatChart>& charts);

// Segments and flattens these pieces (ascending) of a mesh; the mesh's frames are not used. In
// large meshes the pieces are processed in batches of 50 000 triangles, in parallel: pieces do not
// depend on each other, 10^5 of them would need much memory at once, and batches that fit the
// processor's caches are faster. The result does not depend on the number of threads. It is
// incomplete if cancelled.
CutCharts cut_pieces(const FlattenInput& mesh, std::span<const std::uint32_t> pieces,
                     const Context& context);

}  // namespace atlas
