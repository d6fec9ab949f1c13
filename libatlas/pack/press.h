// Internal: few charts on one page, packed as full as a search, a press and exact masks allow.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/pack/chart_outline.h"
#include "libatlas/pack/fit.h"

namespace atlas::pack {

struct PressedPlace {
  bool placed = false;
  double angle = 0;
  Vec2d offset;  // page texel of the shape's origin
  Rect box;      // of the mask, texels
};

// Where a chart should be: its point p at origin + scale · R(angle) (p + from), origin in texels of
// a page whose longer side is the largest allowed.
struct SettleTarget {
  Vec2d origin, from;
  double angle = 0;
};

struct PressedPage {
  double scale = 0;                  // 0: found none
  Extent page;                       // texels; both sides at most options.page_size
  std::vector<PressedPlace> places;  // 1 a shape
  // What the places came from: where bodies lay at this scale, a little larger than `scale`. Empty
  // where charts were not pressed but laid in rows.
  std::vector<SettleTarget> targets;
  double target_scale = 0;
  std::vector<FitProgress> curve;
  std::uint64_t layouts = 0, work = 0;  // of starts; work in words looked at
  std::uint32_t draws = 0;              // of starts, by chance
};

// Where a search begins: before the first round, or after it where `standard` has made it already.
PressedPage begun_page(const FitOptions& options);

// Books a round of a search that has come to `best` after so many seconds: a step of its curve
// where it fills more of the page than before (`use`, a share). Returns the share of the effort, or
// of the time, that is spent.
double book_round(const FitOptions& options, double seconds, double use, PressedPage& best);

// Whether press_outlines is meant for this: one page, no hurry, not too many charts, free turns.
bool worth_pressing(std::span<const ChartOutline> outlines, const FitOptions& options);

// Layouts on coarse cells for several widths of the page, each then pushed together as rigid
// bodies, the best of them placed exactly. The options have been checked.
PressedPage press_outlines(std::span<const ChartOutline> outlines, const FitOptions& options,
                           const Context& context);

// press_outlines draw by draw, for what compares pages and needs few of them in full: the next draw
// of a page, and whether one is worth it, as press_outlines decides except for `best`.
void draw_again(std::span<const ChartOutline> outlines, const FitOptions& options,
                const Context& context, PressedPage& page);
bool worth_another_draw(std::uint32_t draws, double fill, double wanted_fill);

}  // namespace atlas::pack
