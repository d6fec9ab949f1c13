// Internal: the one price of seams.
#pragma once

#include <cstdint>

#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Returns what a linked edge costs in a seam: its length times the user's weight, less in
// proportion to its bend, down to a quarter at `crease_angle` (radians) and beyond, where a seam
// does not show; many times as much inside a polygon. All steps that make, move or remove seams
// compare them by this.
double border_weight(const Topology& topology, std::uint32_t half_edge, double crease_angle);

}  // namespace atlas
