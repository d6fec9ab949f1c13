// Internal: closes seams of charts with themselves that are no longer needed.
#pragma once

#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

// Closes slits whose banks lie on each other to within a millionth of their edges: a plate with
// holes that was cut open and unrolled exactly becomes a ring again. Only done where the chart
// stays injective, by exact predicates. Returns how many charts changed.
std::size_t close_slits(const Topology& topology, std::vector<FlatChart>& charts,
                        const Context& context);

}  // namespace atlas
