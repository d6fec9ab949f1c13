// Internal: uvs for triangles that are new or have changed, beside those that have theirs.
#pragma once

#include <span>

#include "libatlas/core/context.h"
#include "libatlas/unwrap/like/take_uvs.h"

namespace atlas {

struct LayLimits {
  std::span<const Extent> pages = {};
  std::span<const float> density = {};  // MeshView::density
  double max_stretch = 1.25;            // ChartOptions::max_stretch
  double padding = 1;                   // texels that stay free around each chart
};

// Charts grow over triangles without uvs, as far as these reach and no seam of the earlier mesh
// lies in between; where two charts, or two sides of one, meet, there is a seam. Corners that are
// new, or those of triangles that changed too much, are then unfolded and relaxed, while all others
// stay. What would turn over, lie on another triangle, come nearer than the padding to another
// chart, leave its page or take its chart beyond the bound gets no uvs.
void lay_beside(const JoinedMesh& mesh, const LayLimits& limits, PageGrid& grid, TakenUvs& taken);

}  // namespace atlas
