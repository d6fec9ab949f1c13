// Pictures of the light leak: a square of the object across the shadow edge, seen along its normal.
#pragma once

#include <vector>

#include "benchmarks/light_leak/shadow_edge.h"
#include "benchmarks/support/staged.h"

namespace atlas::bench {

struct PatchOptions {
  double side = 0.2;  // scene units
  int pixels = 240;
};

// The same square twice, as display values with 3 channels: the light as the mesh holds it, and as
// the pages show it. Pixels that no triangle covers are white.
struct LeakPicture {
  Image8 input, baked;
};

// Draws the square in which the shadow edge is longest. `pages` must be baked from staged.layout;
// pages without triangles of the object may be empty.
LeakPicture draw_patch(const Staged& staged, const std::vector<Image8>& pages,
                       const ShadowEdge& edge, const PatchOptions& options);

// Returns tiles of equal height side by side with a white gap.
Image8 side_by_side(const std::vector<Image8>& tiles);

}  // namespace atlas::bench
