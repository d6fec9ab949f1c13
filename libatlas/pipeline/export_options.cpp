#include "libatlas/pipeline/export_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "libatlas/core/is_enumerator.h"
#include "libatlas/exporters/world.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/image/webp.h"
#include "libatlas/unwrap/unwrap.h"
#include "libatlas/uvs/placement.h"

namespace atlas {
namespace {

Status out_of_range(const char* field, const std::string& range) {
  return {ErrorCode::bad_option, fmt::format("ExportOptions::{} must be {}", field, range)};
}

Status check_udim(const ExportOptions& o) {
  constexpr std::uint32_t kMostTiles = 8999;  // 1001 to 9999
  if (!o.udim) return {};
  if (lower_extension(o.target) != ".obj" && !o.target.empty())
    return {ErrorCode::bad_option,
            "ExportOptions::udim: only programs that read .obj know UDIM tiles (name an .obj, or "
            "leave ExportOptions::udim out)"};
  if (o.plain_pages > kMostTiles)
    return out_of_range("plain_pages",
                        fmt::format("within 1..{} with ExportOptions::udim", kMostTiles));
  return {};
}

Status check_polygons(const ExportOptions& o) {
  if (!o.polygons || o.target.empty()) return {};
  if (lower_extension(o.target) == ".obj" && !o.keep_scene) return {};
  return {ErrorCode::bad_option,
          "ExportOptions::polygons: only an .obj of uvs alone has faces of more than three corners "
          "(name an .obj without ExportOptions::keep_scene, or leave ExportOptions::polygons out)"};
}

Status check_mesh_uvs(const ExportOptions& o) {
  if (!is_enumerator(o.mesh_uvs, MeshUvs::meshes)) return out_of_range("mesh_uvs", "a MeshUvs");
  if (o.mesh_uvs == MeshUvs::places || o.target.empty()) return {};
  const std::string extension = lower_extension(o.target);
  if (o.keep_scene && (extension == ".gltf" || extension == ".glb")) return {};
  return {
      ErrorCode::bad_option,
      "ExportOptions::mesh_uvs: only a glTF file that keeps its scene shows a mesh several times "
      "(add ExportOptions::keep_scene and write .gltf or .glb)"};
}

Status check_weight(const ExportOptions& o) {
  const bool webp = o.texture_format == TextureFormat::webp;
  if ((webp || o.compress) && !holds_compressed(o.target)) {
    return {ErrorCode::bad_option,
            fmt::format("ExportOptions::{}: only glTF and .html hold that (write .gltf, .glb or "
                        ".html)",
                        webp ? "texture_format" : "compress")};
  }
  if (o.webp_quality < 0 || o.webp_quality > 100)
    return out_of_range("webp_quality", "within 1..100, or 0");
  if (o.webp_quality > 0 && !webp) {
    return {
        ErrorCode::bad_option,
        "ExportOptions::webp_quality: PNG files are lossless (set ExportOptions::texture_format "
        "to webp)"};
  }
  if (webp && o.atlas_size > kLongestWebpSide)
    return out_of_range("atlas_size", "at most 8192 for images of WebP");
  return {};
}

Status check_time_budget(const ExportOptions& o) {
  if (!(o.time_budget >= 0)) return out_of_range("time_budget", "at least 0 seconds");
  if (std::isinf(o.time_budget)) return {};
  if (o.packing != PackPreset::best)
    return {ErrorCode::bad_option,
            "ExportOptions::time_budget is for ExportOptions::packing best (give both or none)"};
  if (o.mesh_uvs == MeshUvs::places && !o.like) return {};
  return {ErrorCode::bad_option,
          fmt::format("ExportOptions::time_budget: is for charts that are all laid out together "
                      "(leave {} out)",
                      o.like ? "ExportOptions::like" : "ExportOptions::mesh_uvs")};
}

}  // namespace

const char* page_extension(TextureFormat format) {
  return format == TextureFormat::webp ? ".webp" : ".png";
}

void use_lightmap_options(double texels_per_metre, ExportOptions& options) {
  const UnwrapOptions lightmap = lightmap_options(texels_per_metre);
  options.square_plain_page = lightmap.square;
  options.plain_mip_levels = lightmap.mip_levels;
  options.plain_padding = lightmap.padding;
  options.plain_part_gaps = lightmap.part_gaps;
  options.larger_plain_page = false;
  options.texel_metres = texels_per_metre > 0 ? 1 / texels_per_metre : 0;
}

Status check_options(const ExportOptions& o) {
  if (Status s = check_world_extension(o.target); !s.ok()) return s;
  if (o.keep_scene && !holds_scene(o.target)) {
    return {ErrorCode::bad_option,
            "ExportOptions::keep_scene: VRML has no room for uvs beside the scene's own, and .html "
            "none for the scene (write .gltf, .glb or .obj)"};
  }
  if (o.linear && !holds_light(o.target) && !o.target.empty()) {
    return {ErrorCode::bad_option,
            "ExportOptions::linear: only pages of HTML hold the light itself (write .html, or add "
            "ExportOptions::exr instead)"};
  }
  if (o.plain_pages < 1) return out_of_range("plain_pages", "at least 1");
  if (o.lightmap_pages < 1) return out_of_range("lightmap_pages", "at least 1");
  if (Status s = check_udim(o); !s.ok()) return s;
  if (Status s = check_polygons(o); !s.ok()) return s;
  if (Status s = check_mesh_uvs(o); !s.ok()) return s;
  if (o.like && o.charts.keep_uv_charts)
    return {ErrorCode::bad_option,
            "ExportOptions::like: its uvs cannot be kept together with the scene's own (leave "
            "ChartOptions::keep_uv_charts out)"};
  if (!o.seams.empty() && o.mesh_uvs != MeshUvs::places)
    return {ErrorCode::bad_option,
            "ExportOptions::seams: only uvs of each place can be cut there (leave "
            "ExportOptions::mesh_uvs out)"};
  if (o.like && o.mesh_uvs != MeshUvs::places)
    return {ErrorCode::bad_option,
            "ExportOptions::like: only uvs of each place can be kept (leave "
            "ExportOptions::mesh_uvs out)"};
  if (o.uv_set < 0 || o.uv_set > 7) return out_of_range("uv_set", "within 1..7, or 0");
  if (o.uv_set > 0 && (!o.keep_scene || lower_extension(o.target) == ".obj")) {
    return {ErrorCode::bad_option,
            "ExportOptions::uv_set: only a glTF file that keeps its scene has several sets of uvs "
            "(add ExportOptions::keep_scene and write .gltf or .glb, or leave "
            "ExportOptions::uv_set out)"};
  }
  if (o.atlases < 1) return out_of_range("atlases", "at least 1");
  if (o.atlas_size < 64 || o.atlas_size > 16384 ||
      !std::has_single_bit(std::uint32_t(o.atlas_size))) {
    return out_of_range("atlas_size", "a power of two from 64 to 16384");
  }
  if (!(o.texel_metres >= 0) || !std::isfinite(o.texel_metres))
    return out_of_range("texel_metres", "a positive length");
  if (!(o.threshold >= 0 && o.threshold <= 1)) return out_of_range("threshold", "within 0..1");
  const std::string levels = fmt::format("within 0..{}", kMostMipLevels);
  if (o.mip_levels < 0 || o.mip_levels > kMostMipLevels) return out_of_range("mip_levels", levels);
  if (o.plain_mip_levels < 0 || o.plain_mip_levels > kMostMipLevels)
    return out_of_range("plain_mip_levels", levels);
  if (o.plain_padding < 0 || o.plain_padding > 64)
    return out_of_range("plain_padding", "within 0..64");
  if (o.shifts < 1 || o.shifts > 64) return out_of_range("shifts", "within 1..64");
  const int room = o.atlas_size - 2 * gutter_pad(o.mip_levels);
  if (o.min_side < 1 || o.min_side > std::min(256, room)) {
    return out_of_range(
        "min_side",
        fmt::format("within 1..{} (ExportOptions::atlas_size {}, ExportOptions::mip_levels {})",
                    std::min(256, room), o.atlas_size, o.mip_levels));
  }
  if (!(o.simplify_slip > 0) || !std::isfinite(o.simplify_slip)) {
    return out_of_range("simplify_slip", "a positive number");
  }
  if (o.png_compression < 0 || o.png_compression > 9) {
    return out_of_range("png_compression", "within 0..9");
  }
  if (!is_enumerator(o.quantity, Quantity::colour)) return out_of_range("quantity", "a Quantity");
  if (!is_enumerator(o.bake_method, BakeMethod::average))
    return out_of_range("bake_method", "a BakeMethod");
  if (!is_enumerator(o.packing, PackPreset::best)) return out_of_range("packing", "a PackPreset");
  if (Status s = check_time_budget(o); !s.ok()) return s;
  if (!is_enumerator(o.up, Up::z)) return out_of_range("up", "an Up");
  if (!is_enumerator(o.texture_format, TextureFormat::webp))
    return out_of_range("texture_format", "a TextureFormat");
  if (!o.false_colour.empty() && lower_extension(o.false_colour) != ".png")
    return out_of_range("false_colour", "the name of a .png file");
  if (Status s = check_weight(o); !s.ok()) return s;
  if (Status s = check_options(o.charts); !s.ok()) return s;
  return check_options(o.tone);
}

}  // namespace atlas
