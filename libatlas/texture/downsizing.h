// Internal: stage 3, which halves a chart's texture as long as no texel changes by the threshold.
#pragma once

#include <array>

#include "libatlas/texture/sample_chart.h"

namespace atlas {

struct Downsizing {
  int halvings = 0;
  int width = 0, height = 0;  // after the halvings
  // Errors of the last texture against the first after bilinear up-sampling, over covered texels.
  double square_sum = 0;  // sum of the squared errors of all three channels
  float max_error = 0;
  std::int64_t covered = 0;
};

// Memory for two textures. It may be used again for other charts.
using HalvedCharts = std::array<SampledChart, 2>;

// Halves both sides of a texture as long as two conditions hold (Barladian et al., section 3, third
// step). In every 2x2 quad, the mean of the covered texels must differ from each of them by less
// than options.threshold in every channel. No side may fall below options.min_side. Quads are
// aligned to the corner; at odd sides the last quad is narrower.
//
// Quads do not see edges that lie between them, such as those of tiles of 16 texels, which
// interpolation then smears over ever more texels. So the last halvings are taken back until the
// interpolated texture differs from the full one by twice the threshold at most.
Downsizing downsize(const SampledChart& full, const TextureOptions& options, HalvedCharts& room);

}  // namespace atlas
