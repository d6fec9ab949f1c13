// Internal: what the different ways to fit charts to pages share when they write their result.
#pragma once

#include <span>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/outlines/chart_outline.h"
#include "libatlas/pack/pressing/press.h"

namespace atlas::pack {

// Where a chart's outline lies. `box` is the box of its mask, gutters included.
struct OutlinePlace {
  Rect box;          // in texels
  double angle = 0;  // in radians, counterclockwise
  Vec2d offset;      // position in the page, in texels, of the shape's origin
};

// Writes the place into `out`, whose scale and page must be set by the caller.
void write_outline(const OutlinePlace& at, const FitOptions& options, FitPlacement& out);

// Does the same for a chart that covers no cell, as a chart without area or gutters may. It is
// placed at the page's corner.
void write_at_corner(const ChartOutline& outline, FitPlacement& out);

// Returns the result of a page on which all charts have the same scale.
FitResult result_of(const PressedPage& page, std::span<const ChartOutline> outlines,
                    const FitOptions& options);

// Removes pages that hold no chart from the result. If charts are equal, fewer than N pages may be
// needed.
void drop_empty_pages(FitResult& result);

// Enlarges a page whose size is not given so that it also holds the box.
void enclose(const Rect& box, const FitOptions& options, Extent& page);

// Returns the sides of a page with a free size as the options require them: equal if pages have to
// be square.
Extent squared(Extent page, const FitOptions& options);

// Returns `content` divided by the area of all pages; 0 if there are no pages.
double share_of_pages(double content, const FitResult& result);

Status no_room(std::size_t charts, const FitOptions& options);

}  // namespace atlas::pack
