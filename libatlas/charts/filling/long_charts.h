// Internal: strips too long for the page that everything else would fit on.
#pragma once

#include <cstddef>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

// A page is at least as long as the longest chart, and as wide as that and the widest of the others
// together, or longer by it. Where that alone leaves more than a quarter of it empty, the longest
// chart, if it is a strip, is cut across into about equal lengths, until it does not; and where a
// page of 2048 texels that is as long as the strip is mostly gutters around many charts, until it
// is as long as a square page or the gutters are a quarter of the charts. Lengths that exceed
// max_stretch stay with the next one. Pieces are as part_of_chart() makes them and take their
// chart's place. Returns how many were cut.
std::size_t cut_long_charts(const FlattenInput& input, std::vector<FlatChart>& charts);

}  // namespace atlas
