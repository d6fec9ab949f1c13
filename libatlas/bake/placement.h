// Where a chart lies on a page, and the one mapping from chart uvs to page texels that baking,
// exporting and error measurement share.
#pragma once

#include <cstdint>

#include "libatlas/core/vec.h"

namespace atlas {

// Chart uvs are scaled along u and v, turned and moved: one similarity a chart, but for charts
// whose two densities differ, which are turned by multiples of 90 degrees only. Never mirrored. The
// inner box holds the chart; `pad` texels around it (see gutter_pad) belong to it as well and are
// filled by the bake. The packer aligns boxes with their pads to 2^mip_levels.
struct ChartPlacement {
  std::uint32_t chart = 0;
  std::int32_t page = -1;
  std::int32_t x = 0, y = 0;           // bottom-left corner of the inner box, page texels
  std::int32_t width = 0, height = 0;  // of the inner box as it lies on the page
  Vec2d texels_per_unit;               // along the chart's u and v
  Vec2d offset;                        // page texels of uv (0, 0)
  double cosine = 1, sine = 0;         // of the turn, counter-clockwise
  // Packed by its outline: the boxes of charts may overlap, and of its box a chart owns only the
  // cells of 2^mip_levels texels a side that lie within `pad` texels of one of its triangles.
  bool outlined = false;
};

// Sets the turn of a chart packed by its box: none, or 90 degrees counter-clockwise.
inline void turn_in_box(ChartPlacement& p, bool quarter) {
  p.cosine = quarter ? 0 : 1;
  p.sine = quarter ? 1 : 0;
  p.offset = {double(p.x + (quarter ? p.width : 0)), double(p.y)};
}

// Texels around an inner box so that a trilinear lookup at mip levels 0..mip_levels never sees a
// neighbour: half a texel of the coarsest level, and at least one.
constexpr int gutter_pad(int mip_levels) {
  return mip_levels <= 1 ? 1 : 1 << (mip_levels - 1);
}

// Page position of a chart uv (ChartSet::uvs, scene units), in texels: texel (i, j) covers
// [i, i+1] x [j, j+1], its centre is (i + 0.5, j + 0.5). Divide by the page's size for
// texture coordinates (origin bottom left).
inline Vec2d page_texel(const ChartPlacement& p, Vec2d uv) {
  const double u = uv.x * p.texels_per_unit.x, v = uv.y * p.texels_per_unit.y;
  return {p.offset.x + p.cosine * u - p.sine * v, p.offset.y + p.sine * u + p.cosine * v};
}

}  // namespace atlas
