// Everything a user may ask of an export. The defaults are meant to be good without a thought.
#pragma once

#include <cstdint>
#include <filesystem>

#include "libatlas/bake/bake.h"
#include "libatlas/charts/charts.h"
#include "libatlas/core/status.h"
#include "libatlas/exporters/world.h"
#include "libatlas/pack/pack.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/tone.h"

namespace atlas {

struct ExportOptions {
  // Its extension chooses the format: .wrl, .wrz, .obj, .gltf, .glb. Images lie beside it.
  std::filesystem::path target = {};

  // The budget: at most `atlases` (>= 1) pages of at most atlas_size² texels (a power of two,
  // 64..16384).
  std::uint32_t atlases = 8;
  std::int32_t atlas_size = 2048;
  // Pages of plain uvs, at most, >= 1. Several are squares of atlas_size.
  std::uint32_t plain_pages = 1;
  // A single page of plain uvs has no image and may be larger: doubled, up to 16384, until it has
  // 1024 texels for each chart on average, so that gutters stay thin against the charts.
  bool larger_plain_page = true;
  // A single page is square, too, for programs that know square textures only; else its shape is
  // what packs best, and textures for these uvs must have that shape.
  bool square_plain_page = false;

  double texel_metres = 0;       // length of a texel on the real surface; 0: as fine as the
                                 // budget could hold, within 1 to 10 mm (paper, stage 2)
  bool follow_textures = true;   // finer where the diffuse texture is finer
  double threshold = 2.0 / 255;  // of downsizing, in display values; 0: no downsizing
  std::int32_t min_side = 16;    // downsizing stops here
  Quantity quantity = Quantity::illuminance;
  ChartOptions charts = {};
  ToneOptions tone = {};

  std::int32_t mip_levels = 2;  // lookups at mip levels 0..mip_levels stay inside a chart
  std::int32_t shifts = 4;      // sub-texel sample grids of the bake
  BakeMethod bake_method = BakeMethod::least_squares;
  PackPreset packing = PackPreset::standard;
  bool outlines = true;  // pack charts by their outlines where that is better than by
                         // their boxes

  bool simplify = true;  // write the coarser mesh
  // Texels that surface and texture may slip, > 0. At 0.5 the test room loses 5.9 dB to silhouettes
  // that moved; at 0.15 it loses 1.8 dB with 2.5 times the triangles.
  double simplify_slip = 0.15;
  Up up = Up::y;
  bool exr = false;                  // also scene-linear OpenEXR pages
  std::int32_t png_compression = 3;  // zlib level 0..9; 1 to 5 are one (PngOptions::smooth)

  bool charts_only = false;  // charts and uvs only: no light is baked, no image written
  // With plain uvs (charts_only, or a scene without light): write the scene's own objects,
  // materials, textures, normals and texture coordinates as well, see World::scene. For .gltf and
  // .glb, and .obj, which has no room for textures. What Scene has no arrays for must have been
  // asked for (ReadOptions::rest), normals too (ReadOptions::normals) but from glTF to glTF;
  // textures may stay encoded.
  bool keep_scene = false;
  bool measure_error = true;  // compare the finished pages with the input's light
};

// Checks every range documented above, and those of charts and tone. The message names the field
// with its struct (ExportOptions::atlas_size), and its range.
Status check_options(const ExportOptions& options);

}  // namespace atlas
