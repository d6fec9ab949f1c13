#include "libatlas/pipeline/size_textures.h"

#include <utility>
#include <vector>

#include "libatlas/pipeline/layout_options.h"
#include "libatlas/unwrap/least_room.h"

namespace atlas {

Result<SizedTextures> size_textures(const ChartLight& light, const PageBudget& budget,
                                    const Context& context) {
  const TextureOptions& texture = budget.texture;
  Result<std::vector<double>> densities = wanted_densities(light, texture, context);
  if (!densities.ok()) return densities.status();
  const double sizing = sizing_factor(light.charts, *densities, budget);
  for (double& density : *densities) density *= sizing;
  const LayoutOptions layout = layout_options(light.charts, budget.options, true);
  if (Status s = check_least_room(light.charts, *densities, layout); !s.ok()) return s;
  Result<TextureResult> sized = size_chart_textures(light, scaled(texture, sizing), context);
  if (!sized.ok()) return sized.status();
  const double refilled = refilled_factor(sizing, *sized, budget);
  if (refilled == sizing) return SizedTextures{std::move(*sized), sizing};
  sized = size_chart_textures(light, scaled(texture, refilled), context);
  if (!sized.ok()) return sized.status();
  return SizedTextures{std::move(*sized), refilled};
}

void report_textures(const TextureResult& textures, ExportReport& report) {
  report.full_texels = textures.full_texels;
  report.final_texels = textures.final_texels;
  report.halved_charts = textures.halved;
  report.uniform_charts = textures.uniform;
  report.unlit_charts = textures.unlit;
  report.capped_charts = textures.capped;
  report.raised_charts = textures.raised;
  report.sampled_charts = textures.sampled;
  report.sampled_texels = textures.sampled_texels;
  report.downsizing_rms = textures.rms_error;
  report.downsizing_max = textures.max_error;
}

}  // namespace atlas
