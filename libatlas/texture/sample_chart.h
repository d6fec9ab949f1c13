// Internal: computes the full-resolution texture of one chart.
#pragma once

#include <vector>

#include "libatlas/texture/chart_textures.h"

namespace atlas {

// A texture of display values. The weight of a texel says how much of it was sampled; 0 means that
// the texel is not covered.
struct SampledChart {
  int width = 0, height = 0;
  struct Texel {
    float rgb[3] = {0, 0, 0};
    float weight = 0;
  };
  std::vector<Texel> texels;  // row 0 at the bottom
};

// Samples the chart at the centre of each covered texel. Triangles that are small or thin compared
// with a texel are averaged by area instead, so that each of them counts. `out` may be used again
// for other charts, because allocating tens of megabytes for each chart costs as much as halving.
void sample_chart(const ChartLight& light, std::uint32_t chart, double texels_per_unit,
                  SampledChart& out);

}  // namespace atlas
