// All options of an export. The defaults are meant to suit most scenes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "libatlas/bake/bake.h"
#include "libatlas/charts/charts.h"
#include "libatlas/core/status.h"
#include "libatlas/exporters/world.h"
#include "libatlas/pack/pack.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/tone.h"

namespace atlas {

struct LoadedScene;

// A file of a caller's own that appears together with the world.
struct ExtraFile {
  std::filesystem::path path = {};
  std::string bytes = {};
};

// Gutters for more mip levels than these would take most of the pages.
constexpr std::int32_t kMostMipLevels = 5;

// The format of the pages' images for viewers.
enum class TextureFormat {
  png,
  webp,  // smaller; only in glTF (EXT_texture_webp)
};

// Returns ".png" or ".webp".
const char* page_extension(TextureFormat format);

// Which uvs a glTF scene that is kept gets where it shows a mesh several times.
enum class MeshUvs {
  places,     // each place has its own, as any viewer reads them: a mesh becomes one for each place
  instances,  // each mesh once; each place has a scale and an offset, for engines
              // (World::instances)
  meshes,     // each mesh once, on a square of its own
};

struct ExportOptions {
  // The extension chooses the format: .wrl, .wrz, .obj, .gltf, .glb, .html. Images
  // are written beside it, except by the last two.
  std::filesystem::path target = {};

  // The budget: at most `atlases` (>= 1) pages of at most atlas_size² texels.
  // atlas_size is a power of two, 64..16384.
  std::uint32_t atlases = 8;
  std::int32_t atlas_size = 2048;
  // The most pages for plain uvs, >= 1. Several pages are squares of side atlas_size.
  std::uint32_t plain_pages = 1;
  // A single page of plain uvs has no image and may be larger. Its side is doubled, up to 16384,
  // until it has 1024 texels for each chart on average, so that gutters stay thin relative to the
  // charts.
  bool larger_plain_page = true;
  // A single page of plain uvs is square, too, for programs that support square textures only.
  // Otherwise it has the shape that packs best, and textures for these uvs must have that shape.
  bool square_plain_page = false;

  // Square pages of plain uvs become UDIM tiles, from 1001 on: the file has the scene's materials
  // (keep_scene) or a single one instead of one per page. Needs an .obj and at most 8999
  // plain_pages, and scenes with light need charts_only.
  bool udim = false;

  // The file has the scene's faces instead of triangles, and no seam runs inside one, unless it
  // cannot lie flat in one piece (ExportReport::cut_polygons): such a face is written as triangles.
  // The scene must have been read with them (ReadOptions::polygons). Needs an .obj without
  // keep_scene, and scenes with light need charts_only.
  bool polygons = false;

  // As mip_levels, for plain uvs; 0..kMostMipLevels. With 0, charts keep two texels between each
  // other, which bilinear lookups need.
  std::int32_t plain_mip_levels = 0;

  // As UnwrapOptions::padding and part_gaps, for plain uvs: texels free around each chart, 0..64, 0
  // for what plain_mip_levels need; whether parts of one chart are kept apart, which they are with
  // keep_scene in any case.
  std::int32_t plain_padding = 0;
  bool plain_part_gaps = false;

  // The length of a texel on the real surface. 0: as fine as the budget could hold, within 1 to
  // 10 mm (paper, stage 2). Where vertices with different light lie closer than 4 mm on average, it
  // may be a quarter of their distance, and in scenes of centimetres a 64th of their side. Plain
  // uvs get pages as large as this length needs, and are refused if these would be larger than may
  // be; 0: as many texels as the pages hold.
  double texel_metres = 0;
  bool follow_textures = true;   // use finer texels where the diffuse texture is finer
  double threshold = 2.0 / 255;  // of downsizing, in display values, 0..1; 0: no downsizing
  // Downsizing makes no side shorter, texels; 1..256, and at most what gutters leave of a page.
  std::int32_t min_side = 16;
  // Textures are sampled, and must then be decoded, only with Quantity::illuminance. With
  // Quantity::colour, ToneOptions::white 0 is 1 rather than measured, so that colours look as they
  // are in the scene.
  Quantity quantity = Quantity::illuminance;
  // A chart does not continue across a crease at which the light jumps visibly. Not with
  // ChartOptions::keep_uv_charts.
  bool split_at_light = true;
  ChartOptions charts = {};
  ToneOptions tone = {};

  // Lookups at levels 0..mip_levels read only the chart's texels; 0..kMostMipLevels.
  std::int32_t mip_levels = 2;
  // If all charts have full size, the same holds for as many more levels as need no more texels.
  bool more_mip_levels = true;
  std::int32_t shifts = 4;  // number of sub-texel sample grids for baking, 1..64
  BakeMethod bake_method = BakeMethod::least_squares;
  PackPreset packing = PackPreset::standard;
  // Wall time of packing with PackPreset::best, seconds, at least 0; what `fast` finds is always
  // there. Infinite: a fixed effort, with which results repeat exactly.
  // Needs MeshUvs::places; not with `like`, whose charts have little to search for.
  double time_budget = std::numeric_limits<double>::infinity();
  bool outlines = true;  // pack charts by outlines if that is better than by boxes

  bool simplify = true;  // write a simplified mesh
  // How far surface and texture may slip, texels, > 0. With 0.5, the test room loses 5.9 dB because
  // silhouettes move. With 0.15, it loses 1.8 dB and has 2.5 times the triangles.
  double simplify_slip = 0.15;
  Up up = Up::y;
  bool exr = false;  // also write scene-linear OpenEXR pages
  // For .html: its pages hold the light itself, so that exposure and tone curve can be chosen, and
  // values read, in the browser.
  bool linear = false;
  TextureFormat texture_format = TextureFormat::png;
  int webp_quality = 0;  // 1..100: lossy, as WebpOptions::quality; 0: lossless
  // Packs the mesh of a glTF file, see World::compress_slip. Positions slip by a quarter of
  // simplify_slip at most.
  bool compress = false;
  std::int32_t png_compression = 3;  // zlib level 0..9; 1 to 5 are the same (PngOptions::smooth)

  // 3 a triangle, or empty: as MeshView::seams, for instance read_seam_lines(). Needs
  // MeshUvs::places.
  std::vector<std::uint8_t> seams = {};
  // An earlier state of the scene with uvs, or null: plain uvs stay like these where triangles are
  // unchanged (UnwrapOptions::like, earlier_scene.h). Needs a scene without light or charts_only,
  // and MeshUvs::places; not with keep_uv_charts. Must outlive the export.
  const LoadedScene* like = nullptr;

  bool charts_only = false;  // make charts and uvs only: bake no light, write no image
  // Also write the scene's own objects, materials, textures, normals and texture coordinates, see
  // World::scene. This works for .gltf and .glb, and for .obj, which cannot hold the textures.
  // Light of the scene becomes a lightmap (World::lightmap) unless charts_only is set: at most
  // lightmap_pages (>= 1; 1 for .obj) pages of at most atlas_size², squares if there are several,
  // with the light as the vertices hold it, without reflectance; the mesh stays as it is. Data that
  // Scene has no arrays for must have been requested (ReadOptions::rest). So must normals
  // (ReadOptions::normals), except from glTF to glTF. Textures may stay encoded.
  bool keep_scene = false;
  // Colours of a glTF file's vertices (COLOR_0) are the light of a scene that is kept only if
  // values beyond 1 prove it, a part of the file has _ILLUMINANCE, or this is set. Otherwise they
  // are paint, and the export is one with charts_only.
  bool colours_are_light = false;
  std::uint32_t lightmap_pages = 1;
  // Others than places need a .gltf or .glb, a scene that was read from glTF with keep_scene, and,
  // if it has light, charts_only. MeshUvs::instances may have several plain_pages.
  MeshUvs mesh_uvs = MeshUvs::places;
  // With keep_scene, for glTF: the set of the new uvs, TEXCOORD_<uv_set>, 1..7. What it holds is
  // replaced, for instance the uvs of an earlier export. 0: the first set that is free.
  int uv_set = 0;
  // Files that appear together with the world, or not at all, such as lists of what it was made
  // from. ExportReport::files does not list them.
  std::vector<ExtraFile> extra_files = {};
  bool durable = false;  // the disk holds all files before the export returns (AtomicFiles::commit)
  // Also draw the light in false colours, from above and on the pages, as a PNG file. Needs light.
  std::filesystem::path false_colour = {};
  bool report_pictures = false;  // make ExportReport::pictures
  bool measure_error = true;     // compare the finished pages with the input's light
};

// Sets the options of plain uvs to those of lightmap_options() (unwrap/unwrap.h), which give the
// same uvs for one page of the same size. `texels_per_metre`: 0 for as many as the pages hold.
void use_lightmap_options(double texels_per_metre, ExportOptions& options);

// Checks every range documented above, and those of charts and tone. The message names the field
// with its struct (ExportOptions::atlas_size), and its range.
Status check_options(const ExportOptions& options);

}  // namespace atlas
