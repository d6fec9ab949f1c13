// Internal: stage 3, halving a chart's texture while no texel moves by the threshold.
#pragma once

#include <array>

#include "libatlas/texture/sample_chart.h"

namespace atlas {

struct Downsizing {
  int halvings = 0;
  int width = 0, height = 0;  // after them
  // The last texture against the first after bilinear up-sampling, over covered texels.
  double square_sum = 0;  // of the errors of all three channels
  float max_error = 0;
  std::int64_t covered = 0;
};

// Room for two textures, which may be used again.
using HalvedCharts = std::array<SampledChart, 2>;

// Barladian et al., section 3, third step: both sides are halved as long as in every 2x2 quad
// (aligned to the corner; at odd sides the last one is narrower) the mean of the covered texels
// differs from each of them by less than options.threshold in every channel, and no side falls
// below options.min_side.
Downsizing downsize(const SampledChart& full, const TextureOptions& options, HalvedCharts& room);

}  // namespace atlas
