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
  // The number of layouts tried, and of words examined, to find the layouts from which pressing
  // starts.
  std::uint64_t layouts = 0, work = 0;
  std::uint32_t draws = 0;  // number of times that random starts were drawn
};

// Returns the page with which a search begins: an empty one, or the state after this many draws,
// which are the most that `standard` makes, if it has been there already.
PressedPage begun_page(const FitSearchOptions& options, std::uint32_t draws);

// Returns the share of the effort, or of the time, that a search has spent which found `best` after
// this many seconds.
double spent_share(const FitOptions& options, double seconds, const PressedPage& best);

// Returns whether press_outlines is suitable: there is one page of at least 256 texels a side, the
// preset is not `fast`, the charts are few, specks aside (specks.h), and may be turned by any
// angle, and they are likely to be larger than half the page at the largest scale.
bool worth_pressing(std::span<const ChartOutline> outlines, const FitOptions& options);

// Makes layouts on coarse cells for several widths of the page, pushes the best of them together as
// rigid bodies, and places the best of these exactly. The options must have been checked.
PressedPage press_outlines(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                           const Context& context);

// These do what press_outlines does, one draw at a time, for callers that compare pages and need
// few of them in full. draw_again makes the next draw of a page; it ends early, and leaves the page
// as it was, once options.wanted_fill is out of reach. worth_another_draw returns whether one is
// worthwhile, by the rule that press_outlines uses for all presets but `best`.
void draw_again(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                const Context& context, PressedPage& page);
bool worth_another_draw(std::uint32_t draws, double fill, double wanted_fill);

}  // namespace atlas::pack
