// Internal: worlds that lie too far from zero for viewers that hold single floats.
#pragma once

#include "libatlas/exporters/world.h"

namespace atlas {

// Returns whether World::origin is farther from zero than 128 times the diagonal of the box of all
// positions. At that distance, floats keep 17 bits of a position within the world; farther away,
// what is seen from near begins to shake and to tear.
bool too_far_for_floats(const World& world);

}  // namespace atlas
