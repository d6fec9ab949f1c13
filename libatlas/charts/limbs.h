// Internal: charts that sprawl over the page are cut, so that the page can be filled.
#pragma once

#include <vector>

#include "libatlas/charts/flatten.h"
#include "libatlas/core/context.h"

namespace atlas {

// A chart whose smallest rectangle covers more than three quarters of all charts' area, and which
// fills clearly less of it than ChartOptions::min_fill, decides how well a page is used: nothing is
// left to put around it. It is cut across, where that takes little seam (find_chords), along edges
// near straight lines, until its pieces fill their rectangles that well or nothing is left to gain,
// into a dozen pieces at most, if the gain is worth the seams. Pieces keep the coordinates they
// have, turned for packing; those of a chart follow each other in its place. Does nothing if a
// piece alone would exceed max_stretch. Returns how many charts were cut.
std::size_t cut_limbs(const FlattenInput& input, std::vector<FlatChart>& charts,
                      const Context& context);

}  // namespace atlas
