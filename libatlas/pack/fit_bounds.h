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

// Whether gutters take most of the pages. Between such charts what cells round away is not what is
// lost, and pressing many, each of which may meet all others along its whole length, costs minutes.
bool are_slivers(std::span<const ChartOutline> outlines, const FitOptions& options);

}  // namespace atlas::pack
