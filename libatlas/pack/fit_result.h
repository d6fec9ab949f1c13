// Internal: what the ways of fitting charts to pages have in common when they write their result.
#pragma once

#include "libatlas/pack/chart_outline.h"
#include "libatlas/pack/fit.h"

namespace atlas::pack {

// Where a chart's outline came to lie; box is its mask's, gutters included.
struct OutlinePlace {
  Rect box;          // texels
  double angle = 0;  // radians, counterclockwise
  Vec2d offset;      // page texel of the shape's origin
};

// Writes the place into `out`, whose scale and page are set already.
void write_outline(const OutlinePlace& at, const FitOptions& options, FitPlacement& out);

// The same for a chart that meets no cell, as one without area or gutters may: it lies at the
// page's corner.
void write_at_corner(const ChartOutline& outline, FitPlacement& out);

// Takes pages that hold no chart out of the result: equal charts may need fewer than N.
void drop_empty_pages(FitResult& result);

// Makes a page without a size of its own hold the box as well.
void enclose(const Rect& box, const FitOptions& options, Extent& page);

// A page's sides as the options want them, when its size is free.
Extent squared(Extent page, const FitOptions& options);

// `content` over the area of all pages; 0 without pages.
double share_of_pages(double content, const FitResult& result);

Status no_room(std::size_t charts, const FitOptions& options);

}  // namespace atlas::pack
