// Internal: finds scales above which outlines cannot fit pages, without packing.
#pragma once

#include <span>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/outlines/chart_outline.h"

namespace atlas::pack {

struct FitBounds {
  double alone = 0;  // above this scale some single chart exceeds the page in every direction
  // Above this scale the charts, if they are connected, and their gutters exceed all pages.
  double with_gutters = 0;
  // The charts' share of the area of charts and gutters, at the smaller of both scales.
  double area_share = 0;
  bool gutters_exceed_pages = false;  // at every scale
};

// Pages are squares of this side in texels. Charts may be turned in this many directions.
FitBounds fit_bounds(std::span<const ChartOutline> outlines, const FitOptions& options,
                     std::int32_t side, std::uint32_t directions);

// Returns whether gutters take most of the page (at least three quarters). Rounding to cells is
// then not the main loss, so pressing gains little. But pressing many such charts takes minutes,
// since each may touch all others along its whole length.
bool are_slivers(std::span<const ChartOutline> outlines, const FitOptions& options);

}  // namespace atlas::pack
