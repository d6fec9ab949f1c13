// Internal: all charts of a set together.
#pragma once

#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

// The distortion of all charts together, each at the scale it is given out with.
Distortion total_distortion(std::span<const Chart> charts);

}  // namespace atlas
