// Internal: from rigid bodies that nearly touch to exact masks on the page's cells.
#pragma once

#include <span>

#include "libatlas/pack/press.h"

namespace atlas::pack {

// Where all charts should be, at this scale.
struct SettleTargets {
  std::span<const SettleTarget> places;  // 1 a chart
  double scale = 1;
};

// Places every chart on free cells as near to its target as possible, at the largest scale
// below the targets' that allows it, then closes up down and to the left. scale 0 in the result:
// none did.
PressedPage settle(const SettleTargets& targets, std::span<const ChartOutline> outlines,
                   const FitOptions& options, const Context& context);

// The same at this scale, at most the targets'; scale 0 in the result: charts found no place.
PressedPage settle_at(double scale, const SettleTargets& targets,
                      std::span<const ChartOutline> outlines, const FitOptions& options,
                      const Context& context);

}  // namespace atlas::pack
