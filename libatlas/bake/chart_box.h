// Internal: ChartBox, the texels around one chart that its bake fits and fills.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "libatlas/bake/bake.h"
#include "libatlas/charts/charts.h"
#include "libatlas/raster/scan.h"

namespace atlas {

// The box of one chart with its pads. Positions inside the box are relative to its lower left
// corner. If the box begins at a multiple of 2^mip_levels, it ends at one, too (or at the page's
// edge), like the packer's box, so that no texel of the coarsest level is filled only in part.
struct ChartBox {
  const ChartPlacement& placement;
  int pad, width, height;

  ChartBox(const ChartPlacement& p, const BakeOptions& o)
      : placement(p),
        pad(gutter_pad(o.mip_levels)),
        width(side(p.x - pad, p.width + 2 * pad, o.page_width, o.mip_levels)),
        height(side(p.y - pad, p.height + 2 * pad, o.page_height, o.mip_levels)) {}

  static int side(int begin, int length, int page, int mip_levels) {
    const int unit = 1 << mip_levels;
    if (begin % unit != 0) return length;
    return std::min((begin + length + unit - 1) / unit * unit, page) - begin;
  }

  // The page texel at the lower left corner of the box.
  int left() const { return placement.x - pad; }
  int bottom() const { return placement.y - pad; }

  const Chart& chart(const ChartSet& charts) const { return charts.charts[placement.chart]; }

  TexelTriangle triangle(const ChartSet& charts, std::uint32_t t) const {
    TexelTriangle out;
    for (int k = 0; k < 3; ++k) {
      const Vec2d q = page_texel(placement, charts.uvs[charts.triangle_uv[3 * std::size_t(t) + k]]);
      out[k] = {q.x - placement.x + pad, q.y - placement.y + pad};
    }
    return out;
  }
};

}  // namespace atlas
