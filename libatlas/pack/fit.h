// The joint problem of an exporter: N pages of at most S × S texels, and the largest common scale
// at which all charts fit. Solved by packing, not by area alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/pack/outline.h"
#include "libatlas/pack/pack.h"

namespace atlas {

// Size of a chart's texture in texels at scale 1; finite, >= 0.
struct FitItem {
  double width = 0, height = 0;
};

struct FitOptions {
  std::uint32_t pages = 1;        // N, at least 1
  std::int32_t page_size = 2048;  // S, texels, at least alignment + 2 padding
  bool power_of_two = true;       // page sides are powers of two <= S (else multiples of alignment)
  bool square = false;
  std::int32_t padding = 2;    // texels kept free on each side of a chart: 2^(M-1) for mips 0..M
  std::int32_t alignment = 4;  // boxes begin and end at multiples of this: 2^M
  std::int32_t minimum_side = 16;  // a side never shrinks below min(this, its size at scale 1)
  double max_scale = 1;            // > 0; the scale returned is at most this
  bool allow_rotation = true;      // quarter turns
  PackPreset preset = PackPreset::standard;
  // Full packings spent on the search for the scale, at least 2; as many again with more than four
  // directions where four find no room.
  std::uint32_t max_packings = 25;
  // Charts as outlines instead of boxes: one an item in the texels of the items' sizes, or empty.
  // Placements are then of the mask's box, boxes may overlap, masks never do. See outline.h.
  std::span<const ChartShape> shapes;
  std::uint32_t rotations = 4;  // directions tried for outlines at most: multiples of
                                // 360/rotations degrees; 1, 2, 4 or a multiple of 4
  bool any_angle = true;        // outlines may be turned by angles between those, too
  // Several pages of few outlines each are pressed one by one, and charts exchanged between them:
  // a twentieth to a sixth more of the pages is filled, for some tenths of a second a page.
  bool press_pages = true;
  // A single page: its sides are at most page_size, and outlines are made to fill it as far as they
  // can instead of being as large as they can be. Overrides power_of_two and square. Without
  // shapes, or with several pages, it does that alone.
  bool free_aspect = false;
  // What fills less of a single page than this is of no use (a share): a page of outlines that
  // comes out far emptier at first, or does not come to it as long as `best` wins something, is
  // searched no further. 0: search as usual.
  double wanted_fill = 0;
  // Limits of `best` on a single page of outlines. The result depends on effort and seed only,
  // unless effort is 0 and time the limit.
  double time_budget = 1.0;  // wall seconds
  std::uint64_t effort = 0;  // layouts tried at most, checked every few hundred; 0: no limit.
                             // Those that take long count for several
  std::uint64_t seed = 1;
  // Of `best` where a single page of outlines is pressed or laid in rows: the layouts that
  // `standard` has tried of the same items. They count as effort, and what would only repeat them
  // is left out.
  std::uint64_t tried = 0;
};

// A point of the curve of density against effort.
struct FitProgress {
  double seconds = 0;         // wall time since the start
  std::uint64_t layouts = 0;  // tried so far
  double utilization = 0;
};

// The box of chart i in its page, padding included, after rotation; content = box without
// padding. With boxes: content_width × content_height texels are the chart's scaled size rounded
// up (before rotation), placed at (box.x + padding, box.y + padding), and rotated tells whether
// width and height are swapped (a quarter turn counterclockwise: chart point (u, v) goes to
// (box.x + padding + content_height - v, box.y + padding + u)).
// With outlines: chart point p (texels at scale 1) goes to offset + scale · R(angle) · p; the
// content is the shape's own box, and minimum_side holds for its longer side, so that charts keep
// their proportions.
struct FitPlacement {
  std::uint32_t page = 0;
  Rect box;
  std::int32_t content_width = 0, content_height = 0;
  bool rotated = false;
  double angle = 0;  // radians, counterclockwise; 0 or pi/2 for boxes
  // Of this chart's outline: the common scale, or more where minimum_side asks for it. With boxes
  // the common scale: each axis has its own, content / size at scale 1, which rounding up and
  // minimum_side make larger.
  double scale = 1;
  Vec2d offset;  // outlines only
};

struct FitResult {
  double scale = 1;
  std::vector<FitPlacement> placements;  // 1 an item
  std::vector<Extent> pages;             // of those that hold something; at most N
  double utilization = 0;  // area of contents (boxes) or of the shapes (outlines) / area of pages
  double box_utilization = 0;  // area of the boxes with gutters / area of pages (boxes only)
  // Of small holes and narrow bays in shapes, where no shape could lie: texels² at scale 1; with
  // outlines only.
  double lost_area = 0;
  GroupingResult grouping;                     // of the box areas at the final scale
  std::uint32_t moved_items = 0;               // items that did not fit their group's page
  std::uint32_t packings = 0;                  // full packings tried
  std::uint64_t layouts = 0;                   // of outlines, on one page each: tried in all
  std::vector<std::pair<double, bool>> trace;  // (scale, did it fit) in the order tried
  std::vector<FitProgress> curve;              // improvements in the order found; may be empty
};

// Finds the largest common scale <= max_scale at which every item fits. At each scale: groups by
// F(A) = N on box areas, packs each group into its page (largest first), moves what did not fit
// into whatever page still has room, and failing that packs all pages jointly. Bisection between
// an area bound and the best scale seen to fit; feasibility is not monotone, so the answer is
// the largest scale that was *seen* to fit. Minimum sides that exceed all pages by themselves are
// refused without a packing.
// If everything fits at max_scale, pages are made as few, then as small, as packing finds.
// Errors: bad_option, bad_input (negative or non-finite size), no_solution (the minimum sides
// alone do not fit N pages), cancelled.
Result<FitResult> fit_pages(std::span<const FitItem> items, const FitOptions& options,
                            const Context& context);

// The last step of fit_pages with press_pages, for a fit to outlines made without: what it returned
// for the same items and options, denser where pressing makes it so.
Result<FitResult> press_fit(FitResult fitted, std::span<const FitItem> items,
                            const FitOptions& options, const Context& context);

}  // namespace atlas
