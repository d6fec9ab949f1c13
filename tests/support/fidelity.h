// Compares an exported world with its lit scene by casting rays into both from the same cameras.
#pragma once

#include <filesystem>

#include "tests/support/world_mesh.h"

namespace atlas::test {

struct ViewOptions {
  int cameras = 12, width = 480, height = 320;
};

// Display values are sRGB-encoded, 0 to 1. The export must have used linear tone mapping; its
// single scale factor is fitted.
struct Fidelity {
  double psnr = 0;                    // dB over all pixels that hit either; 120 if nothing differs
  double p50 = 0, p99 = 0, p999 = 0;  // percentiles of a pixel's largest absolute difference
  double bad8 = 0;                    // share of pixels that differ by more than 8/255
  double miss = 0;                    // share of pixels that hit only one of the two
  double scale = 0;                   // display value per unit of scene light
  double white = 0;  // display value of the scene's 99th percentile; 1 for a well exposed export
  std::size_t cameras = 0, triangles_in = 0, triangles_out = 0, pages = 0;
};

// Places cameras in open places inside the scene's box, looking in directions of long sight. They
// are the same for the same scene and options. In a scene without open places there are 0 cameras.
Fidelity compare_views(const WorldMesh& scene, const WorldMesh& world, const ViewOptions& options);

}  // namespace atlas::test
