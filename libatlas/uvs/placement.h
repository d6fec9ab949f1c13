// Defines where a chart lies on a page, and the one mapping from chart uvs to page texels that
// baking, exporting and error measurement share.
#pragma once

#include <cstdint>

#include "libatlas/core/vec.h"

namespace atlas {

// A placement scales a chart's uvs along u and v, turns them and moves them, but never mirrors
// them. It is one similarity for the whole chart; a chart whose two densities differ is turned by
// multiples of 90 degrees only. The inner box holds the chart. The `pad` texels around the box (see
// gutter_pad) belong to the chart as well, and the bake fills them. The packer aligns boxes with
// their pads to multiples of 2^mip_levels texels.
struct ChartPlacement {
  std::uint32_t chart = 0;
  std::int32_t page = -1;
  std::int32_t x = 0, y = 0;           // bottom-left corner of the inner box, page texels
  std::int32_t width = 0, height = 0;  // of the inner box as it lies on the page
  Vec2d texels_per_unit = {};          // along the chart's u and v
  Vec2d offset = {};                   // position of uv (0, 0), page texels
  double cosine = 1, sine = 0;         // of the angle of the turn, counter-clockwise
  // Whether the chart was packed by its outline. The boxes of such charts may overlap: of its box,
  // a chart owns only the cells of 2^mip_levels texels a side that come within `pad` texels of one
  // of its triangles.
  bool outlined = false;
};

// Sets the turn and the offset of a chart that was packed by its box: if `quarter`, it is turned by
// 90 degrees counter-clockwise, else not at all.
inline void turn_in_box(ChartPlacement& p, bool quarter) {
  p.cosine = quarter ? 0 : 1;
  p.sine = quarter ? 1 : 0;
  p.offset = {double(p.x + (quarter ? p.width : 0)), double(p.y)};
}

// Returns how many texels around an inner box a chart needs so that a trilinear lookup at mip
// levels 0..mip_levels never reads a neighbour: half a texel of the coarsest level, and at least
// one.
constexpr int gutter_pad(int mip_levels) {
  return mip_levels <= 1 ? 1 : 1 << (mip_levels - 1);
}

// Returns the page position of a chart uv (ChartSet::uvs, scene units), in texels. Texel (i, j)
// covers [i, i+1] x [j, j+1], and its centre is (i + 0.5, j + 0.5). Divided by the page's size, the
// position is a texture coordinate (origin bottom left).
inline Vec2d page_texel(const ChartPlacement& p, Vec2d uv) {
  const double u = uv.x * p.texels_per_unit.x, v = uv.y * p.texels_per_unit.y;
  return {p.offset.x + p.cosine * u - p.sine * v, p.offset.y + p.sine * u + p.cosine * v};
}

// Undoes page_texel(): returns the chart uv at a page position in texels.
inline Vec2d chart_uv(const ChartPlacement& p, Vec2d texel) {
  const double x = texel.x - p.offset.x, y = texel.y - p.offset.y;
  return {(p.cosine * x + p.sine * y) / p.texels_per_unit.x,
          (p.cosine * y - p.sine * x) / p.texels_per_unit.y};
}

}  // namespace atlas
