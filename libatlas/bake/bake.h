// Stage 5, second half: rasterising the light of the fine triangles into one atlas page.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/bake/placement.h"
#include "libatlas/core/context.h"
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/texture/chart_textures.h"

namespace atlas {

enum class BakeMethod {
  // The texels whose bilinear interpolation is nearest to the light over the chart, in the least
  // squares sense (see docs/bake.md). Default: measured better than `average`.
  least_squares,
  // As published: each texel is the mean over all triangles that touch it, weighted by the
  // area they cover, repeated on shifted grids and averaged.
  average,
};

struct BakeOptions {
  int page_width = 2048, page_height = 2048;  // texels: those of PageLayout::pages
  int shifts = 4;      // K: sub-texel sample grids, 1..64; rounded up to a square
  int mip_levels = 2;  // lookups at levels 0..mip_levels stay inside the chart's own texels, on
                       // pages packed for them
  BakeMethod method = BakeMethod::least_squares;
  // Also give scene-linear floats: for EXR, and for signals at the vertices that are no light,
  // which tone mapping and sRGB would bend. Values below 0 are only given where some vertex has
  // one.
  bool linear = false;
};

struct BakedPage {
  Image8 display;               // RGB, tone-mapped, sRGB-encoded; row 0 at the bottom
  ImageF linear;                // RGB, scene-linear luminance; empty unless asked for
  std::uint64_t triangles = 0;  // baked
  // Told by samples: those whose bilinear look-ups one enters (least squares), which reaches up to
  // a texel beyond the triangles, or those that a triangle touches (average).
  std::uint64_t covered_texels = 0;
  std::uint64_t filled_texels = 0;  // the rest of boxes and pads, filled from the covered ones
  // That several charts claim: 0 on pages packed for as many mip levels.
  std::uint64_t contested_texels = 0;
};

// Bakes the given placements, all of one page, in parallel over charts; the same for any thread
// count. Pages are to be packed for these mip levels, with gutter_pad(mip_levels) texels of padding
// and an alignment of 2^mip_levels (LayoutOptions, or UnwrapOptions::mip_levels). Where they are
// not, a texel that several charts claim goes to the nearest, of equally near ones to the lower
// number: look-ups at level 0 are right as long as two texels lie between charts, coarser ones mix
// their light. Such texels are counted, and told by Context::warn.
// Texels of no chart take colours from around them in `display`, for the coarser mip levels that a
// viewer may build, and are black in `linear`.
// Errors: bad_option; bad_input when a box with its pad leaves the page, or where light is not
// finite (check_light); cancelled.
Result<BakedPage> bake_page(const ChartLight& light, std::span<const ChartPlacement> placements,
                            const BakeOptions& options, const Context& context);

}  // namespace atlas
