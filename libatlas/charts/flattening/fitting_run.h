// Internal: finds the part of a common border along which two flat charts fit.
#pragma once

#include <span>
#include <vector>

#include "libatlas/charts/flattening/joint.h"

namespace atlas {

// Returns the longest run of `edges`, the border of `a` with `b`, that has no gap in either chart
// and a misfit of at most `most_misfit` (Motion::misfit, relative to the run's length). Lengths are
// rounded to 1024ths of the whole; among equal ones the first wins. At worst quadratic in the
// number of edges.
std::vector<BorderEdge> find_fitting_run(const Topology& topology, const ChartPair& pair,
                                         std::span<const BorderEdge> edges, double most_misfit);

}  // namespace atlas
