// What the exported world shows at the viewpoint where viewers start.
#pragma once

#include <filesystem>

#include "benchmarks/tone/light_scenes.h"
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas::bench {

constexpr int kLookWidth = 192, kLookHeight = 120;

struct FirstLook {
  Image8 picture = {};
  double median = 0;  // luma of the display values, 0 to 255, of pixels that show something
  double burnt = 0;   // share of those with a channel at 255 that no lamp or sunlight explains
  double lit = 0;     // share of those with at least a hundredth of the 90th percentile of light
};

// Casts rays from the viewpoint of a .glb, an export of `scene` with z up. Errors: those of
// read_scene(); bad_input without a viewpoint.
Result<FirstLook> look_at(const std::filesystem::path& world, const LightScene& scene,
                          const Context& context);

}  // namespace atlas::bench
