// The second half of stage 5: rasterises the light of the fine triangles into one atlas page.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/context.h"
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/uvs/placement.h"

namespace atlas {

enum class BakeMethod {
  // Finds the texels whose bilinear interpolation is nearest to the light over the chart, in the
  // least squares sense (see docs/bake.md). This is the default, because its error was measured to
  // be lower than that of `average`.
  least_squares,
  // As published: each texel is the mean of the light of all triangles that touch it, weighted by
  // the area that they cover, over all shifted grids.
  average,
};

struct BakeOptions {
  int page_width = 2048, page_height = 2048;  // texels, as in PageLayout::pages
  int shifts = 4;  // K, the number of sub-texel sample grids, 1..64; rounded up to a square
  // On pages packed for it, lookups at levels 0..mip_levels read only the chart's own texels.
  int mip_levels = 2;
  BakeMethod method = BakeMethod::least_squares;
  // Also return scene-linear floats: for EXR, and for signals at the vertices that are not light,
  // which tone mapping and sRGB would distort. The floats are below 0 only if some vertex has a
  // value below 0.
  bool linear = false;
};

struct BakedPage {
  Image8 display = {};  // RGB, tone-mapped, sRGB-encoded; row 0 at the bottom
  ImageF linear = {};   // RGB, scene-linear luminance; empty unless BakeOptions::linear is set
  std::uint64_t triangles = 0;  // how many were baked
  // Texels that samples determine. With least_squares these are the texels that some sample's
  // bilinear look-up reads, which reach up to a texel beyond the triangles. With average they are
  // the texels that a triangle touches.
  std::uint64_t covered_texels = 0;
  // Texels that several charts claim. There are none on pages that were packed for as many mip
  // levels.
  std::uint64_t contested_texels = 0;
};

// Bakes the given placements, which must all lie on one page, in parallel over charts. The result
// is the same for any number of threads. The page should have been packed for the same mip levels,
// with gutter_pad(mip_levels) texels of padding and an alignment of 2^mip_levels (LayoutOptions, or
// UnwrapOptions::mip_levels). Otherwise several charts may claim the same texel. Such a texel goes
// to the nearest chart, and among equally near ones to the chart with the lower number. Look-ups at
// level 0 are then still right if two texels lie between charts, but coarser levels mix the light
// of the charts. Contested texels are counted, and reported through Context::warn.
// Texels that belong to no chart take colours from around them in `display`, for the coarser mip
// levels that a viewer may build. In `linear` they are black.
// Errors: bad_option; bad_input if a placement names no chart or no page, if its box with the pad
// leaves the page, if its cosine and sine are not those of an angle (to 1e-5), if its density is
// not above 0 or puts the chart too far off its box, or if chart or light are not usable
// (check_light); cancelled.
Result<BakedPage> bake_page(const ChartLight& light, std::span<const ChartPlacement> placements,
                            const BakeOptions& options, const Context& context);

}  // namespace atlas
