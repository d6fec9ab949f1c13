// Stages 2 and 3: how many texels each chart needs.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/tone.h"

namespace atlas {

// The light on a set of charts: what is sampled, where, and how it is shown. All of it must
// outlive the calls it is given to.
struct ChartLight {
  const LuminanceSampler& sampler;
  const ChartSet& charts;
  const ToneMapping& tone;
};

// Errors: bad_input, naming triangle and vertex, where the chart's light is no number or beyond
// 1e36: one such value would spread over the texels around it.
Status check_light(const ChartLight& light, std::uint32_t chart);

struct TextureOptions {
  double texel = 0.005;          // length of a texel on the surface, scene units; > 0
  bool follow_textures = true;   // raise the density to the diffuse texture's own
  double texture_sampling = 1;   // times this, > 0: at 1 a texel may straddle two of the texture's
  double threshold = 2.0 / 255;  // largest |mean - texel| that still halves; <= 0: no downsizing
  int min_side = 16;             // halving stops before a side falls below this
  int max_side = 2040;           // longest inner side a page can take: finer charts are coarsened
};

enum class ChartContent : std::uint8_t { varied, uniform, unlit };

// The texture of one chart. Full: as stage 2 asks; final: after stage 3.
struct ChartTexture {
  Vec2d texels_per_unit;               // final density along the chart's u and v
  std::int32_t width = 0, height = 0;  // final inner box, texels
  Vec2d full_texels_per_unit;
  std::int32_t full_width = 0, full_height = 0;
  std::int32_t halvings = 0;  // of varied charts; uniform ones shrink a side at a time
  ChartContent content = ChartContent::varied;
  bool capped = false;   // max_side made it coarser than asked
  bool sampled = false;  // its texels were looked at: of several colours, large enough to halve
  float rms_error = 0;   // display values: final against full, after bilinear up-sampling,
  float max_error = 0;   // over covered texels and RGB; 0 where nothing was sampled or lost
};

struct TextureResult {
  std::vector<ChartTexture> charts;                // one a chart, same order
  std::int64_t full_texels = 0, final_texels = 0;  // sums of width * height
  std::uint64_t halved = 0, uniform = 0, unlit = 0, capped = 0, raised = 0;  // counts of charts
  std::uint64_t sampled = 0;                                                 // charts
  std::int64_t sampled_texels = 0;      // of those, full texels that a triangle covers
  double rms_error = 0, max_error = 0;  // over sampled_texels; all others lose nothing
};

// Texels per unit that stage 2 asks for each chart, before any limit of a page: from the texel's
// length, raised where the chart's diffuse texture is finer.
std::vector<double> wanted_densities(const ChartLight& light, const TextureOptions& options,
                                     const Context& context);

// Inner box of a chart of `size` units at the given density: at least 1 x 1.
struct TexelSize {
  std::int32_t width = 0, height = 0;
};
TexelSize texel_size(Vec2d size, Vec2d texels_per_unit);

// Sizes every chart's texture. Sampled a chart at a time on each thread (float RGB of one
// chart a thread is the largest thing held); charts of one colour are not sampled at all.
// The threshold is compared with tone-mapped, sRGB-encoded values in [0, 1]: equal steps there
// are about equally visible, and it is what the atlas stores.
// Source: Barladian et al., section 3, steps 2 and 3.
// Errors: bad_option; bad_input (see check_light); cancelled.
Result<TextureResult> size_chart_textures(const ChartLight& light, const TextureOptions& options,
                                          const Context& context);

}  // namespace atlas
