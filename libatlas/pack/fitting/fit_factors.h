// Internal: the scale of each chart of a fit.
#pragma once

#include <span>
#include <vector>

#include "libatlas/pack/fit.h"

namespace atlas::pack {

// Returns one factor per chart: the common scale, or a larger one if minimum_side demands it for
// the chart's longer side.
std::vector<double> chart_factors(std::span<const FitItem> items, const FitOptions& options,
                                  double scale);

// Returns whether some chart would be larger than at this scale because of minimum_side.
bool below_minimum_side(std::span<const FitItem> items, const FitOptions& options, double scale);

}  // namespace atlas::pack
