// Internal: scales beyond which outlines cannot fit pages, found without packing.
#pragma once

#include <span>

#include "libatlas/pack/chart_outline.h"
#include "libatlas/pack/fit.h"

namespace atlas::pack {

struct FitBounds {
  double alone = 0;         // at larger ones some chart alone exceeds the page in every direction
  double with_gutters = 0;  // at larger ones charts, if connected, and gutters exceed all pages
  double area_share = 0;    // of the charts' area, against gutters, at the smaller of both
  bool gutters_exceed_pages = false;  // whatever the scale
};

// Pages are squares of this side in texels; charts are turned in so many directions.
FitBounds fit_bounds(std::span<const ChartOutline> outlines, const FitOptions& options,
                     std::int32_t side, std::uint32_t directions);

}  // namespace atlas::pack
