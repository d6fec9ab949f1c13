// How seams look on the surface.
#pragma once

#include "tests/support/atlas_measure.h"

namespace atlas::bench {

// Lengths are divided by the square root of the surface area. An edge that two triangles share in
// space, but not in uv, is a seam.
struct SeamQuality {
  double seam = 0;
  // Each piece of seam counts by the share of the sky that its two faces see (cosine-weighted rays
  // that hit nothing), and by 1 - bend / 60 degrees, at least 0: what one sees of the seams.
  double visible_smooth = 0;
  // Path / chord over windows of eight mean edge lengths along seams; 1 is straight.
  double jag = 1;
};

// Precondition: vertices of equal position are one, and every face has uvs.
SeamQuality measure_seams(const test::UvMesh& mesh);

}  // namespace atlas::bench
