#include "apps/atlas-export/flag_names.h"

#include <array>
#include <utility>

namespace atlas::app {
namespace {

using FlagName = std::pair<std::string_view, std::string_view>;
constexpr std::array<FlagName, 33> kFlagNames{{
    {"ExportOptions::atlases", "--atlases"},
    {"ExportOptions::lightmap_pages", "--atlases"},
    {"ExportOptions::plain_pages", "--atlases"},
    {"ExportOptions::atlas_size", "--atlas-size"},
    {"ExportOptions::texel_metres", "--texel"},
    {"ExportOptions::threshold", "--threshold"},
    {"ExportOptions::min_side", "--min-side"},
    {"ExportOptions::mip_levels", "--mips"},
    {"ExportOptions::plain_mip_levels", "--mips"},
    {"ExportOptions::shifts", "--shifts"},
    {"ExportOptions::simplify_slip", "--slip"},
    {"ExportOptions::png_compression", "--png-level"},
    {"ExportOptions::texture_format", "--texture-format"},
    {"ExportOptions::webp_quality", "--quality"},
    {"ExportOptions::compress", "--compress"},
    {"ExportOptions::false_colour", "--false-colour"},
    {"ExportOptions::charts_only", "--charts-only"},
    {"ExportOptions::keep_scene", "--keep-scene"},
    {"ExportOptions::uv_set", "--uv-set"},
    {"ExportOptions::udim", "--udim"},
    {"ExportOptions::quantity", "--quantity"},
    {"ExportOptions::split_at_light", "--across-light"},
    {"ChartOptions::cone_degrees", "--cone"},
    {"ChartOptions::max_stretch", "--max-stretch"},
    {"ChartOptions::crease_degrees", "--crease"},
    {"ChartOptions::split_at_materials", "--across-materials"},
    {"ChartOptions::keep_uv_charts", "--keep-uv-charts"},
    {"ChartOptions::uv_aspect", "--uv-aspect"},
    {"ToneOptions::op", "--tone"},
    {"ToneOptions::white", "--white"},
    {"ToneOptions::exposure_stops", "--exposure"},
    {"ReadOptions::metres_per_unit", "--unit"},
    {"ReadOptions::illumination_file", "--illumination"},
}};

bool in_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
}

}  // namespace

std::string with_flag_names(std::string_view text) {
  std::string out(text);
  for (const auto& [field, flag] : kFlagNames) {
    std::size_t at = 0;
    while ((at = out.find(field, at)) != std::string::npos) {
      const std::size_t end = at + field.size();
      if (end < out.size() && in_name(out[end])) {
        at = end;  // a longer name
      } else {
        out.replace(at, field.size(), flag);
        at += flag.size();
      }
    }
  }
  return out;
}

}  // namespace atlas::app
