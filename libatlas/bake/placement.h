// Where a chart lies on a page, and the one mapping from chart uvs to page texels that baking,
// exporting and error measurement share.
#pragma once

#include <cstdint>

#include "libatlas/core/vec.h"

namespace atlas {

// The inner box holds the chart; `pad` texels around it (see gutter_pad) belong to it as well and
// are filled by the bake. The packer aligns boxes with their pads to 2^mip_levels.
struct ChartPlacement {
  std::uint32_t chart = 0;
  std::int32_t page = -1;
  std::int32_t x = 0, y = 0;           // bottom-left corner of the inner box, page texels
  std::int32_t width = 0, height = 0;  // of the inner box as it lies on the page
  bool rotated = false;                // by 90 degrees counter-clockwise, never mirrored
  Vec2d texels_per_unit;               // along the chart's u and v
  // Packed by its outline: the boxes of charts may overlap, and of its box a chart owns only the
  // cells of 2^mip_levels texels a side that lie within `pad` texels of one of its triangles. It is
  // turned by any angle then, and `rotated` says nothing.
  bool outlined = false;
  Vec2d offset;                 // page texels of uv (0, 0)
  double cosine = 1, sine = 0;  // of the turn, counter-clockwise
};

// Texels around an inner box so that a trilinear lookup at mip levels 0..mip_levels never sees a
// neighbour: half a texel of the coarsest level, and at least one.
constexpr int gutter_pad(int mip_levels) {
  return mip_levels <= 1 ? 1 : 1 << (mip_levels - 1);
}

// Page position of a chart uv (ChartSet::uvs, scene units), in texels: texel (i, j) covers
// [i, i+1] x [j, j+1], its centre is (i + 0.5, j + 0.5). Divide by the page's size for
// texture coordinates (origin bottom left). Rotated: (u, v) -> (h - v, u).
inline Vec2d page_texel(const ChartPlacement& p, Vec2d uv) {
  const double u = uv.x * p.texels_per_unit.x, v = uv.y * p.texels_per_unit.y;
  if (p.outlined)
    return {p.offset.x + p.cosine * u - p.sine * v, p.offset.y + p.sine * u + p.cosine * v};
  if (p.rotated) return {p.x + (p.width - v), p.y + u};
  return {p.x + u, p.y + v};
}

}  // namespace atlas
