// Solves the joint problem of an exporter: given N pages of at most S × S texels, it finds the
// largest common scale at which all charts fit. The scale is found by packing, not from areas
// alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/pack/outline.h"
#include "libatlas/pack/pages.h"

namespace atlas {

// The size of a chart's texture in texels at scale 1. Both sides are finite and >= 0.
struct FitItem {
  double width = 0, height = 0;
};

// N is `pages`, and S is `page_size`, which is alignment + 2 padding .. 2^20.
struct FitOptions : PageOptions {
  // Page sides are powers of two <= S; otherwise multiples of alignment.
  bool power_of_two = true;
  // A side never becomes smaller than min(this, its size at scale 1).
  std::int32_t minimum_side = 16;
  double max_scale = 1;  // > 0; the scale that is found is at most this
  // Number of full packings that the search for the scale may use; at least 2. If four directions
  // find no room, the search with more than four directions may use as many again.
  std::uint32_t max_packings = 25;
  // Packs the charts as outlines instead of boxes. The list is empty or has one shape per item, in
  // the texels of the items' sizes. Each placement is then that of the mask's box. Boxes may
  // overlap, but masks never do. See outline.h.
  std::span<const ChartShape> shapes = {};
  // Maximum number of directions tried for outlines, in multiples of 360/rotations degrees; 1, 2, 4
  // or a multiple of 4.
  std::uint32_t rotations = 4;
  bool any_angle = true;  // outlines may also be turned by angles between those
  // If there are several pages with few outlines each, every page is pressed by itself, and charts
  // are exchanged between pages. This fills a twentieth to a sixth more of the pages and takes some
  // tenths of a second per page.
  bool press_pages = true;
  // For a single page of outlines: the page may take any shape with sides of at most page_size, and
  // the outlines are packed so that they fill it as far as possible, instead of being as large as
  // possible. This overrides power_of_two and square. Without shapes it does nothing else. With
  // several pages it also turns press_pages off.
  bool free_aspect = false;
  // Limits of `best` for outlines. The result depends on effort and seed only, unless effort is 0
  // and time is the limit. More of either never gives a worse fit, time on a machine that is as
  // fast.
  double time_budget = 1.0;  // wall time in seconds, at least 0 or infinite
  // Work, in half a million words that are examined, about a millisecond each; 0: no limit. A round
  // of the search is only begun if it leaves some of it; the first always is.
  std::uint64_t effort = 0;
  std::uint64_t seed = 1;
  // For fit_boxes_or_outlines: the area that the shapes cover at scale 1, in square texels. 0: the
  // sum of their triangles, which is the same unless charts overlap themselves.
  double shapes_area = 0;
};

// The place of one chart. `box` is the chart's box in its page after rotation, padding included.
// The content is the box without padding.
// With boxes: content_width × content_height texels are the chart's scaled size before rotation,
// rounded up. The content is placed at (box.x + padding, box.y + padding). `rotated` means that
// width and height are swapped by a quarter turn counterclockwise: the chart point (u, v) goes to
// (box.x + padding + content_height - v, box.y + padding + u).
// With outlines: the chart point p (texels at scale 1) goes to offset + scale · R(angle) · p. The
// content is the shape's own box. minimum_side applies to the shape's longer side, so that charts
// keep their proportions.
struct FitPlacement {
  std::uint32_t page = 0;
  Rect box = {};
  std::int32_t content_width = 0, content_height = 0;
  bool rotated = false;
  double angle = 0;  // in radians, counterclockwise; 0 or pi/2 for boxes
  // With outlines this is the scale of this chart: the common scale, or a larger one if
  // minimum_side demands it. With boxes it is the common scale. There each axis has a scale of its
  // own, which is the content divided by the size at scale 1; rounding up and minimum_side make it
  // larger.
  double scale = 1;
  Vec2d offset = {};  // set for outlines, and by fit_boxes_or_outlines
};

struct FitResult {
  double scale = 1;
  std::vector<FitPlacement> placements = {};  // one per item
  std::vector<Extent> pages = {};             // the pages that hold something; at most N
  // Area of the contents (boxes) or shapes (outlines) / area of the pages.
  double utilization = 0;
  // Set by fit_boxes_or_outlines: whether the placements are those of boxes, and the area of the
  // shapes, as they are scaled, / area of the pages.
  bool boxes = false;
  double filled = 0;
  // The area of small holes and narrow bays in shapes in which no shape could lie, in square texels
  // at scale 1. Set for outlines only.
  double lost_area = 0;
  // The grouping at the final scale of the boxes' areas, or of the outlines', with their gutters,
  // in texels.
  GroupingResult grouping = {};
  std::uint32_t packings = 0;  // number of full packings tried
  // Number of layouts of outlines on one page that were tried. Those on pages of other sizes, and
  // those of ways of packing that gained nothing, are not all counted.
  std::uint64_t layouts = 0;
};

// Finds the largest common scale <= max_scale at which every item fits. At each scale it groups the
// box areas by F(A) = N, packs each group into its page (largest items first), and moves the items
// that did not fit into any page that still has room. If that fails, it packs all pages jointly;
// 4000 boxes or more are packed jointly at once.
// The scale is found by bisection between an area bound and the best scale that was seen to fit.
// Whether a scale fits is not monotone, so the result is the largest scale that was *seen* to fit.
// If the minimum sides alone exceed all pages, the items are refused without a packing. If
// everything fits at max_scale, the number of pages is made as small as packing allows, and then
// their size.
// Errors: bad_option, bad_input (negative or non-finite size), no_solution (the minimum sides alone
// do not fit N pages), cancelled.
Result<FitResult> fit_pages(std::span<const FitItem> items, const FitOptions& options,
                            const Context& context);

// Does fit_pages by boxes, and by outlines if these may win, and returns the better fit: the one of
// the larger scale, of the smaller pages if the scales are equal, or of the fuller page with
// free_aspect. Round charts of one size, for instance, lie more densely in rows of boxes than a
// search over outlines finds. options.shapes has one shape per item. Placements of boxes get offset
// and angle as those of outlines have them: where no minimum side holds, the chart point p goes to
// offset + scale · R(angle) · p in either case. Errors: those of fit_pages.
Result<FitResult> fit_boxes_or_outlines(std::span<const FitItem> items, const FitOptions& options,
                                        const Context& context);

}  // namespace atlas
