#include "apps/atlas-export/flag_names.h"

#include <array>

#include "apps/common/options.h"

namespace atlas::app {
namespace {

constexpr std::array<FlagName, 44> kFlagNames{{
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
    {"ExportOptions::like", "--like"},
    {"ExportOptions::seams", "--seams"},
    {"ExportOptions::polygons", "--polygons"},
    {"ExportOptions::mesh_uvs", "--instances"},
    {"ExportOptions::linear", "--linear"},
    {"ExportOptions::exr", "--exr"},
    {"ExportOptions::packing", "--packing"},
    {"ExportOptions::time_budget", "--budget"},
    {"ExportOptions::quantity", "--quantity"},
    {"ExportOptions::colours_are_light", "--quantity"},
    {"ExportOptions::split_at_light", "--across-light"},
    {"ChartOptions::cone_degrees", "--cone"},
    {"ChartOptions::max_stretch", "--max-stretch"},
    {"ChartOptions::crease_degrees", "--crease"},
    {"ChartOptions::split_at_materials", "--across-materials"},
    {"ChartOptions::keep_uv_charts", "--keep-uv-charts"},
    {"ChartOptions::uv_aspect", "--uv-aspect"},
    {"ChartOptions::min_fill", "--min-fill"},
    {"ChartOptions::seam_weight", "--seam-weight"},
    {"ToneOptions::op", "--tone"},
    {"ToneOptions::white", "--white"},
    {"ToneOptions::exposure_stops", "--exposure"},
    {"ReadOptions::metres_per_unit", "--unit"},
    {"ReadOptions::illumination_file", "--illumination"},
}};

}  // namespace

std::string with_flag_names(std::string_view text) {
  return with_flags(with_flags(text, kFlagNames), kTrustFlags);
}

}  // namespace atlas::app
