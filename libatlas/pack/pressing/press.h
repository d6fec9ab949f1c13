// Internal: packs few charts on one page as densely as a search, pressing and exact masks allow.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/pack/outlines/chart_outline.h"
#include "libatlas/pack/pressing/fit_search_options.h"

namespace atlas::pack {

struct PressedPlace {
  bool placed = false;
  double angle = 0;
  Vec2d offset;  // position in the page, in texels, of the shape's origin
  Rect box;      // the mask's box in texels
};

// Where a chart should lie. Its point p should be at origin + scale · R(angle) (p + from). The
// origin is in texels of a page whose longer side is the largest allowed.
struct SettleTarget {
  Vec2d origin, from;
  double angle = 0;
  bool anywhere = false;  // a speck, which has no target and goes into any gap
};

struct PressedPage {
  double scale = 0;                  // 0: no layout was found
  Extent page;                       // in texels; both sides are at most options.page_size
  std::vector<PressedPlace> places;  // one per shape
  // The targets from which the places were made: the poses of the rigid bodies at target_scale,
  // which is a little larger than `scale`. Empty if the charts were laid in rows instead of
  // pressed.
  std::vector<SettleTarget> targets;
  double target_scale = 0;
  // The number of layouts tried to find those from which pressing starts.
  std::uint64_t layouts = 0;
};

// Returns whether press_outlines is suitable: there is one page of at least 256 texels a side, the
// preset is not `fast`, the charts are few, specks aside (specks.h), and may be turned by any
// angle, and they are likely to be larger than half the page at the largest scale.
bool worth_pressing(std::span<const ChartOutline> outlines, const FitOptions& options);

// Makes layouts on coarse cells for several widths of the page, pushes the best of them together as
// rigid bodies, and places the best of these exactly. The options must have been checked.
PressedPage press_outlines(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                           const Context& context);

}  // namespace atlas::pack
