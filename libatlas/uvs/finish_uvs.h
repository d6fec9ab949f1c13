// Internal: the last step of uvs, the same for calls and files: floats that turn no triangle over,
// and charts that graphics hardware draws without covering a texel twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"
#include "libatlas/uvs/page_uvs.h"

namespace atlas {

struct FinishOptions {
  bool baked = false;           // the pages hold light already, so charts stay in their places
  std::int32_t mip_levels = 0;  // for which the pages are prepared
  std::int32_t padding = 0;     // texels that are free around each chart
};

struct FinishedUvs {
  std::vector<Vec2f> uvs = {};                  // one per uv of the charts: 0..1 over its page
  std::vector<ChartPlacement> placements = {};  // as given, but for moves by fractions of a texel
  std::size_t thin_triangles = 0;               // that rounding closes or turns over
  std::size_t texels_drawn_twice = 0;           // that are left; 0 if the pages are baked
};

// Rounds the uvs of placed charts (round_uvs.h) and moves charts so that fewer texels are drawn
// twice (draw_once.h). Where light is baked, now or later, uvs stay within a texel of where the
// placements say. Charts are moved only where neither light nor mip levels need their place.
// `corners` are those of the written triangles, three each, indices into the charts' uvs,
// counter-clockwise. Charts that stay (PlacedCharts::stays) are rounded, and nothing else. The
// result is the same for every thread count. It is incomplete if cancelled.
FinishedUvs finish_uvs(const PlacedCharts& placed, std::span<const std::uint32_t> corners,
                       const FinishOptions& options, const Context& context);

}  // namespace atlas
