#include "libatlas/pipeline/lightmap.h"

#include <fmt/format.h>

namespace atlas {

bool has_lightmap(bool lit, const ExportOptions& options) {
  return lit && options.keep_scene && !options.charts_only;
}

Lightmap lightmap_of(const ExportReport& report, const ExportOptions& options) {
  const std::string name = page_name(options.target, 0);
  Lightmap map;
  map.images.push_back(name + ".png");
  if (options.exr) map.images.push_back(name + ".exr");
  if (options.tone.op == ToneOperator::linear) map.white = report.exposure_white;
  return map;
}

std::string lightmap_text(const Lightmap& lightmap) {
  const std::string scale =
      lightmap.white > 0
          ? fmt::format("white is {:.4g} of the light at the vertices", lightmap.white)
          : "after the tone curve";
  std::string text = fmt::format("lightmap: {} (sRGB-encoded, {})", lightmap.images[0], scale);
  if (lightmap.images.size() > 1) text += fmt::format(", {} (linear)", lightmap.images[1]);
  return text;
}

}  // namespace atlas
