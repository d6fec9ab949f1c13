// Internal: joins small charts and fragments with their neighbours.
#pragma once

#include <vector>

#include "libatlas/charts/flattening/chart_job.h"
#include "libatlas/core/context.h"

namespace atlas {

struct AbsorbInput {
  const FlattenInput& flatten;
  Partition& partition;
  ChartScratch& scratch;
};

// Tries to join charts with their neighbours, smallest first. Tried are fragments
// (FlatChart::fragment), small charts (up to 1.5 % of their piece's area), charts of few
// triangles and, in meshes of up to 400 000 triangles, the two charts of a piece that has no
// others; with the preset `best`, all charts. Each is flattened together with the neighbour that it
// shares most border with, and with the next ones if that fails. Small charts that fit no neighbour
// along their whole border are joined along a part of it. A union is kept if it meets all limits,
// does not sprawl, and costs no more stretch than a multiple of what the seam was worth. Charts
// that were joined to others are removed from `charts`. The order of trials, and so the result, is
// the same for every thread count.
void absorb_charts(const AbsorbInput& input, std::vector<FlatChart>& charts,
                   const Context& context);

}  // namespace atlas
