// Charts that are too long for a page at the density asked for, cut into pieces that are not.
#pragma once

#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

// Cuts every chart whose box is longer than its limit (scene units, 1 a chart, > 0) across its long
// side, again and again, until the pieces fit or are single triangles. A cut runs along edges, near
// the even share, where it crosses the fewest triangles: on regular meshes it is straight.
// Triangles go to the side of their centroid. Pieces keep their parent's uvs, shifted (and turned
// by 90 degrees where that lays their long side along u), and so its injectivity; each hangs
// together by edges. Cone and axis stay the parent's; distortion is measured anew. Charts within
// their limit keep their order; pieces follow in place of their parent. Returns how many charts
// were cut.
std::size_t cut_to_limits(const MeshView& mesh, std::span<const double> limits, ChartSet& charts);

}  // namespace atlas
