// Internal: the ways to solve a packing problem, and the choice between them.
#pragma once

#include "libatlas/pack/problem.h"

namespace atlas::pack {

// Solves by the preset. Fills in page_lower_bound, layouts_tried and curve of the result.
Layout solve(const Problem& problem, const PackOptions& options, const Context& context,
             PackResult& result);

}  // namespace atlas::pack
