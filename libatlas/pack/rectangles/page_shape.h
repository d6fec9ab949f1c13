// Internal: pages that may be smaller than the largest size allowed.
#pragma once

#include "libatlas/pack/rectangles/cells.h"
#include "libatlas/pack/rectangles/engines.h"

namespace atlas::pack {

// Returns the page that is reported if `used` texels of it are used: cropped and rounded up as the
// options demand. Sides that are not given are multiples of the alignment, unless the largest page
// is no multiple and has no room for that.
Extent shaped_page(Extent used, const PackOptions& options);

// Returns the width of a free page in cells. It is that of a square that the items would fill to 95
// %, but at least the width of every item, and at most `most`.
std::int32_t square_width(const Problem& problem, std::int32_t most);

// Solves the problem according to the preset. If the page is free, or is cropped and holds all
// items, other widths are tried as well, and the smallest page is taken. Items of cropped pages are
// moved together (pull_in.h).
Layout solve_shape(const Problem& problem, const PackOptions& options, const Context& context,
                   PackResult& result);

}  // namespace atlas::pack
