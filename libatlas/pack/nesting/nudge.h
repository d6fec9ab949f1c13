// Internal: moves masks apart that overlap by few cells.
#pragma once

#include <vector>

#include "libatlas/core/rect.h"
#include "libatlas/pack/nesting/pair_overlaps.h"

namespace atlas::pack {

// Moves masks by a cell or two at a time, until no two of them overlap, by guided local search:
// each goes where its overlaps weigh least, and the weights of overlaps that persist grow. The
// masks must fit the page, whose sides are in cells, and are moved into it first. Returns false if
// some still overlap after a fixed number of rounds.
bool nudge_apart(const Extent& page, std::vector<PlacedMask>& masks, double& work);

}  // namespace atlas::pack
