// Pictures of charts: each mesh in space and its page below, with one colour per chart and with
// seams.
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

// Draws one column of `side` x 2 `side` pixels per mesh, with z up, seen from the front right.
// Shows only the first page.
Image8 charts_picture(const std::vector<UnwrappedMesh>& meshes, int side);

}  // namespace atlas::bench
