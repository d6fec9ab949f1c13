// Internal: cuts strips that are too long for the page that all other charts would fit on.
#pragma once

#include <cstddef>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

// A page is at least as long as the longest chart, and as wide as that chart and the widest other
// one together, or longer by that other one. Where these two alone leave more than a quarter of it
// empty, the longest chart, if it is a strip, is cut across into about equal lengths until they do
// not. It is also cut where a page of 2048 texels as long as the strip would be mostly gutters
// around many charts, until the strip is as long as a square page or the gutters take a quarter of
// the charts' area. Lengths that exceed max_stretch stay with the next one. Pieces are made by
// part_of_chart(), and take their chart's place. Returns how many charts were cut, which are fewer
// when cancelled.
std::size_t cut_long_charts(const FlattenInput& input, std::vector<FlatChart>& charts,
                            const Context& context);

}  // namespace atlas
