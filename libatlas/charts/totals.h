// Internal: sums over all charts of a set.
#pragma once

#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

// Returns the distortion of all charts together, each at the scale of its uvs.
Distortion total_distortion(std::span<const Chart> charts);

}  // namespace atlas
