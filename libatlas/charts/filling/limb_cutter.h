// Internal: a flat chart that sprawls, cut across where its limbs begin.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

// Cuts a chart across, where that takes little seam (find_chords), along edges near straight lines,
// and large frames through their middles (cut_middle), until its pieces fill `wanted` (0..1) of
// their smallest rectangles, or are so many that these matter less than their hulls, or nothing is
// left to gain, into 32 pieces or a few more. `all_charts`: area of all that share the page.
// Returns the triangles of each piece, as places in chart.triangles, ascending; nothing if the gain
// is not worth the seams, or the context is cancelled.
std::vector<std::vector<std::uint32_t>> limbs_of(const FlatChart& chart, double wanted,
                                                 double all_charts, const Context& context);

}  // namespace atlas
