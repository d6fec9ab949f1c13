// Internal: the full-resolution texture of one chart.
#pragma once

#include <vector>

#include "libatlas/texture/chart_textures.h"

namespace atlas {

// Display values and how much of each texel was sampled; 0: not covered.
struct SampledChart {
  int width = 0, height = 0;
  struct Texel {
    float rgb[3] = {0, 0, 0};
    float weight = 0;
  };
  std::vector<Texel> texels;  // row 0 at the bottom
};

// One sample at the centre of each covered texel; triangles small or thin beside a texel are
// averaged by area instead, so that every one of them counts.
// `out` may be used again: allocating tens of megabytes anew for each chart costs as much as
// halving.
void sample_chart(const ChartLight& light, std::uint32_t chart, double texels_per_unit,
                  SampledChart& out);

}  // namespace atlas
