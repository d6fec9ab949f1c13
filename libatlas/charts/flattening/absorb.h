// Internal: gives small charts another chance to be part of a neighbour.
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

// Fragments (FlatChart::fragment), small charts (of a hundredth or two of their piece's area) and
// those of few triangles (with the preset `best`: all), smallest first, are flattened together with
// the neighbour that they share most border with, the next ones if that fails; small ones that fit
// none along their whole border are joined along a part of it. They stay joined if the union meets
// all limits and does not sprawl, and if, fragments apart, it costs no more stretch than the seam
// was worth. Charts that were joined to others are removed from `charts`. In order, so the same for
// every thread count.
void absorb_charts(const AbsorbInput& input, std::vector<FlatChart>& charts,
                   const Context& context);

}  // namespace atlas
