// Internal: the part of a common border along which two flat charts fit.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/flattening/joint.h"

namespace atlas {

// The longest run of `edges`, the border of `a` with `b`, without a gap in either chart and with no
// more than that misfit (Motion::misfit, by the run's length). Lengths that differ by less than a
// 1024th of all count as equal: the first one wins. At worst quadratic in the number of edges.
std::vector<BorderEdge> find_fitting_run(const Topology& topology, const ChartPair& pair,
                                         std::span<const BorderEdge> edges, double most_misfit);

}  // namespace atlas
