// Internal: cuts a sprawling flat chart across where its limbs begin.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

struct LimbLimits {
  double wanted;      // share of their smallest rectangles that pieces are to fill, 0..1
  double all_charts;  // area of all charts that share the page
  std::span<const std::uint32_t> polygons = {};  // as for LineCutter
};

// Cuts a chart across along edges near straight lines, where that takes little seam (find_chords),
// and large frames through their middles (cut_middle). Stops when the pieces fill `wanted` of
// their smallest rectangles, when there are so many that these matter less than their hulls,
// when nothing is left to gain, or at 32 pieces or a few more. Returns the triangles of each piece
// as indices into chart.triangles, ascending; nothing if the gain is not worth the seams, or the
// context is cancelled.
std::vector<std::vector<std::uint32_t>> limbs_of(const FlatChart& chart, const LimbLimits& limits,
                                                 const Context& context);

}  // namespace atlas
