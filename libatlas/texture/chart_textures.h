// Stages 2 and 3 of the export: determine how many texels each chart needs.
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

// The light on a set of charts: the light itself, the charts it lies on, and the tone mapping that
// shows it. All three must outlive the calls they are passed to.
struct ChartLight {
  const LuminanceSampler& sampler;
  const ChartSet& charts;
  const ToneMapping& tone;
};

// Whether the charts are those of the sampler's scene, as far as the number of triangles tells.
// Error: bad_input, also if the charts' arrays are not as long as these triangles need or name
// charts or triangles that do not exist, or if the tone mapping has no operator.
Status check_scene_of(const ChartLight& light);

// Checks a chart of such a set and its light. Errors: bad_input if the chart reaches beyond the
// set, or one of its triangles beyond the chart; bad_input, which names triangle and vertex, if the
// light times reflectance is not a number or is beyond 1e36. One such value would spread over the
// texels around it.
Status check_light(const ChartLight& light, std::uint32_t chart);

struct TextureOptions {
  double texel = 0.005;          // length of a texel on the surface, scene units; > 0
  bool follow_textures = true;   // raise the density to the diffuse texture's own
  double texture_sampling = 1;   // times this, > 0; at 1 a texel may straddle two of the texture's
  double threshold = 2.0 / 255;  // halve while |mean - texel| is below this; <= 0: no downsizing
  int min_side = 16;             // halving stops before a side falls below this
  int max_side = 2040;           // longest inner side that fits a page; finer charts are coarsened
  // For pages that also hold light above display white (EXR): the threshold then applies to the
  // light shown with this luminance as white, too. 0: light above display white does not count.
  double brightest = 0;
};

enum class ChartContent : std::uint8_t { varied, uniform, unlit };

// The texture of one chart. "Full" sizes are those that stage 2 asks for, and "final" sizes are
// those after stage 3.
struct ChartTexture {
  Vec2d texels_per_unit = {};          // final density along the chart's u and v
  std::int32_t width = 0, height = 0;  // final inner box, texels
  Vec2d full_texels_per_unit = {};
  std::int32_t full_width = 0, full_height = 0;
  std::int32_t halvings = 0;  // of varied charts; uniform ones shrink each side on its own
  ChartContent content = ChartContent::varied;
  bool capped = false;   // max_side made it coarser than requested
  bool sampled = false;  // its texels were computed: several colours, large enough to halve
  // Errors of display values: the final texture against the full one after bilinear up-sampling,
  // over covered texels and RGB. They are 0 if nothing was sampled or lost.
  float rms_error = 0;
  float max_error = 0;
};

struct TextureResult {
  std::vector<ChartTexture> charts = {};           // one a chart, in the same order
  std::int64_t full_texels = 0, final_texels = 0;  // sums of width * height
  std::uint64_t halved = 0, uniform = 0, unlit = 0, capped = 0, raised = 0;  // counts of charts
  std::uint64_t sampled = 0;                                                 // charts
  std::int64_t sampled_texels = 0;      // full texels of these charts that a triangle covers
  double rms_error = 0, max_error = 0;  // over sampled_texels; all other texels lose nothing
};

// Returns the texels per unit that stage 2 asks for, for each chart, before any limit of a page.
// The density follows from the texel's length, and is raised if the chart's diffuse texture is
// finer. Errors: bad_option; bad_input (see check_scene_of(), and check_light() for what it says
// about charts); cancelled.
Result<std::vector<double>> wanted_densities(const ChartLight& light, const TextureOptions& options,
                                             const Context& context);

// The inner box of a chart of `size` units at the given density. It has at least 1 x 1 texels.
struct TexelSize {
  std::int32_t width = 0, height = 0;
};
TexelSize texel_size(Vec2d size, Vec2d texels_per_unit);

// Determines the size of every chart's texture. Each thread samples one chart at a time, and the
// RGB floats of these charts are the largest data in memory. Charts of one colour are not sampled
// at all. The threshold is compared with tone-mapped, sRGB-encoded values in [0, 1], because equal
// steps there are about equally visible, and because the atlas stores these values. Source:
// Barladian et al., section 3, steps 2 and 3. Errors: bad_option; bad_input (see check_light and
// check_scene_of); cancelled.
Result<TextureResult> size_chart_textures(const ChartLight& light, const TextureOptions& options,
                                          const Context& context);

}  // namespace atlas
