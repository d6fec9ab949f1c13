// Pictures of charts: each mesh in space and its page below, one colour a chart, seams drawn.
#pragma once

#include <filesystem>
#include <vector>

#include "libatlas/core/image.h"
#include "tests/support/atlas_measure.h"

namespace atlas::bench {

struct UnwrappedMesh {
  test::UvMesh mesh;
  double aspect = 1;  // width / height of the first page
};

// One column of `side` x 2 `side` pixels a mesh, z up, seen from the front right; the page's first
// page only.
Image8 charts_picture(const std::vector<UnwrappedMesh>& meshes, int side);

}  // namespace atlas::bench
