#include "libatlas/pipeline/lightmap.h"

#include <fmt/format.h>

#include "libatlas/files/file_extension.h"
#include "libatlas/scene/gltf/gltf_kept_colours.h"

namespace atlas {
namespace {

std::string first_to_last(const std::vector<std::string>& names) {
  return names.size() == 1 ? names[0] : names.front() + " to " + names.back();
}

}  // namespace

bool has_lightmap(bool lit, const ExportOptions& options) {
  return lit && options.keep_scene && !options.charts_only;
}

bool keeps_paint(const Scene& scene, const ExportOptions& options) {
  const KeptColours colours = kept_colours(scene);
  return options.keep_scene && !options.colours_are_light && !colours.illuminance &&
         colours.values == GltfColours::within_one;
}

std::string colours_text(const Scene& scene, const ExportOptions& options) {
  const KeptColours colours = kept_colours(scene);
  if (!options.keep_scene || options.charts_only || colours.values == GltfColours::none) return "";
  if (keeps_paint(scene, options))
    return "COLOR_0 is taken as paint and stays, since no value is beyond 1: the new uvs are "
           "without light (ExportOptions::colours_are_light takes it as light)";
  const char* why = options.colours_are_light ? "as ExportOptions::colours_are_light says"
                    : colours.values == GltfColours::beyond_one
                        ? "since values are beyond 1"
                        : "since parts of the file have _ILLUMINANCE";
  return fmt::format(
      "COLOR_0 is taken as light where there is no _ILLUMINANCE, {} (ExportOptions::charts_only "
      "leaves it as it is)",
      why);
}

bool holds_pages(const ExportOptions& options, bool bake) {
  if (!options.keep_scene || options.udim || options.mesh_uvs == MeshUvs::instances) return true;
  return bake && lower_extension(options.target) != ".obj";
}

Lightmap lightmap_of(const ExportReport& report, const ExportOptions& options) {
  Lightmap map;
  for (std::size_t p = 0; p < report.pages.size(); ++p) {
    const std::string name = page_name(options.target, p);
    map.images.push_back(name + page_extension(options.texture_format));
    if (options.exr) map.linear.push_back(name + ".exr");
  }
  if (options.tone.op == ToneOperator::linear) map.white = report.exposure_white;
  return map;
}

std::string lightmap_text(const Lightmap& lightmap) {
  const std::string scale =
      lightmap.white > 0
          ? fmt::format("white is {:.4g} of the light at the vertices", lightmap.white)
          : "after the tone curve";
  std::string text =
      fmt::format("lightmap: {} (sRGB-encoded, {})", first_to_last(lightmap.images), scale);
  if (!lightmap.linear.empty())
    text += fmt::format(", {} (linear)", first_to_last(lightmap.linear));
  return text;
}

}  // namespace atlas
