// Internal: hangs small rough charts on a neighbour by one edge.
#pragma once

#include <vector>

#include "libatlas/charts/flatten.h"

namespace atlas {

// Under scan noise, small charts that no neighbour could take in keep their shape, but for a scale,
// and are laid beside a larger neighbour so that one edge of their common border closes; the rest
// of it becomes a seam of the chart with itself, as if the neighbour had been cut around what is
// rough in it. Smallest first, each where its neighbour's rectangle grows least. What then exceeds
// the bound on stretch, overlaps or sprawls is undone. Charts that were hung on others are removed
// from `charts`; those that carry them are measured and turned anew. Smooth meshes and charts under
// a limit on cones are left alone. In order, so the same for every thread count.
void hang_flaps(const FlattenInput& input, Partition& partition, std::vector<FlatChart>& charts,
                const Context& context);

}  // namespace atlas
