// Internal: moves the items of finished layouts together, so that pages can be cropped further.
#pragma once

#include "libatlas/pack/rectangles/problem.h"

namespace atlas::pack {

// Moves every item left until it meets another one or the page's edge, then down, and repeats both
// as long as something moves, a few times at most. No item moves right or up, so the layout stays
// within the part of the page that it used. The engines put some items against the right edge of
// their page, which a cropped page would have to reach. Pages of many items that are full already
// stay as they are. Ignores pinned rectangles. Takes O(n log n).
void pull_in(const Problem& problem, Layout& layout);

}  // namespace atlas::pack
