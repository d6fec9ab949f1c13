// Internal: a flat chart that sprawls, cut across where its limbs begin.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

// Cuts a chart across, where that takes little seam (find_chords), along edges near straight lines,
// until its pieces fill `wanted` (0..1) of their smallest rectangles or nothing is left to gain,
// into a dozen pieces at most. Returns the triangles of each piece, as places in chart.triangles,
// ascending; nothing if the gain is not worth the seams, or the context is cancelled.
std::vector<std::vector<std::uint32_t>> limbs_of(const FlatChart& chart, double wanted,
                                                 const Context& context);

}  // namespace atlas
