// Internal: strips too long for the page that everything else would fit on.
#pragma once

#include <cstddef>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

// A page is at least as long as the longest chart, and as wide as that and the widest of the others
// together, or longer by it. Where that alone leaves more than a quarter of it empty, the longest
// chart, if it is a strip, is cut across into equal lengths, until it does not; triangles that a
// cut leaves beside their length go to the next one. Pieces are as part_of_chart() makes them and
// take their chart's place. A strip stays whole if a piece would come apart all the same, or exceed
// max_stretch. Returns how many were cut.
std::size_t cut_long_charts(const FlattenInput& input, std::vector<FlatChart>& charts);

}  // namespace atlas
