// How an exported world looks beside its lit scene: both are ray-cast from the same cameras.
#pragma once

#include <filesystem>

#include "tests/support/world_mesh.h"

namespace atlas::test {

struct ViewOptions {
  int cameras = 12, width = 480, height = 320;
};

// Display values are sRGB-coded, 0..1. The export must have used linear tone mapping: its one scale
// factor is fitted.
struct Fidelity {
  double psnr = 0;  // dB over all pixels that either hits; 120 where nothing differs
  double p50 = 0, p99 = 0, p999 = 0;  // percentiles of a pixel's largest absolute difference
  double bad8 = 0;                    // share of pixels off by more than 8/255
  double miss = 0;                    // share of pixels that only one of the two hits
  double scale = 0;                   // display value a unit of scene light
  double white = 0;  // display value of the scene's 99th percentile: 1 is a well exposed export
  std::size_t cameras = 0, triangles_in = 0, triangles_out = 0, pages = 0;
};

// Cameras stand in open places inside the scene's box and look where it is far to see; the same
// ones for the same scene and options. 0 cameras are found in a scene that nobody can stand in.
Fidelity compare_views(const WorldMesh& scene, const WorldMesh& world, const ViewOptions& options);

}  // namespace atlas::test
