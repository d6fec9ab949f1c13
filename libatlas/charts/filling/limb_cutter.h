// Internal: cuts a sprawling flat chart across where its limbs begin.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

// Cuts a chart across along edges near straight lines, where that takes little seam (find_chords),
// and large frames through their middles (cut_middle). Stops when the pieces fill `wanted` (0..1)
// of their smallest rectangles, when there are so many that these matter less than their hulls,
// when nothing is left to gain, or at 32 pieces or a few more. `all_charts` is the area of all
// charts that share the page. Returns the triangles of each piece as indices into chart.triangles,
// ascending; nothing if the gain is not worth the seams, or the context is cancelled.
std::vector<std::vector<std::uint32_t>> limbs_of(const FlatChart& chart, double wanted,
                                                 double all_charts, const Context& context);

}  // namespace atlas
