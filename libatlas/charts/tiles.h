// Charts that are too long for a page at the density asked for, cut into pieces that are not.
#pragma once

#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

// Cuts every chart whose box is longer than its limit (scene units, 1 a chart, > 0) across its long
// side, again and again, until the pieces fit or no cut divides them. A cut is the shortest way
// along edges near the even share: on regular meshes it is straight. Pieces keep their parent's
// uvs, shifted (and turned by 90 degrees where that lays their long side along u), and so its
// injectivity. What stretched a small part of a chart by more than max_stretch may be a large part
// of a piece: such a piece is relaxed, or cut further; not so where the parent itself exceeds it
// or was given (Chart::kept).
// Each piece hangs together by edges. Cone and axis stay the parent's; distortion is measured anew,
// the total as well. Charts within their limit keep their order; pieces follow in place of their
// parent. Returns how many charts were cut.
std::size_t cut_to_limits(const MeshView& mesh, std::span<const double> limits, double max_stretch,
                          ChartSet& charts);

}  // namespace atlas
