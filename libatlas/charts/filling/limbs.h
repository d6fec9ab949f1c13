// Internal: cuts charts that sprawl over the page, so that the page can be filled.
#pragma once

#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

// Cuts two kinds of charts across (limbs_of()). First, charts whose smallest rectangle covers at
// least the area of all charts, and that fill clearly less of it than ChartOptions::min_fill: they
// determine how well a page is used, since nothing is left to put around them. Second, if all
// charts fill less than 0.68 of their convex hulls together, as strips at odd angles that unroll as
// one do, the most wasteful charts first until the rest fill that much. Pieces are made by
// part_of_chart(); those of a chart follow each other in its place. A chart stays whole if a piece
// exceeds max_stretch. Returns how many charts were cut.
std::size_t cut_limbs(const FlattenInput& input, std::vector<FlatChart>& charts,
                      const Context& context);

}  // namespace atlas
