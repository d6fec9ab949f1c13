// Internal: charts that sprawl over the page are cut, so that the page can be filled.
#pragma once

#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

// A chart whose smallest rectangle covers more than all charts' area, and which fills clearly less
// of it than ChartOptions::min_fill, decides how well a page is used: nothing is left to put around
// it. So do charts that fill less than 0.68 of their convex hulls together, as strips at odd angles
// do, which unroll as one; there the most wasteful are cut first, until the rest fill that much.
// Such charts are cut as limbs_of() says. Pieces are as part_of_chart() makes them; those of a
// chart follow each other in its place. A chart stays whole if a piece
// exceeds max_stretch. Returns how many charts were cut.
std::size_t cut_limbs(const FlattenInput& input, std::vector<FlatChart>& charts,
                      const Context& context);

}  // namespace atlas
