// Internal: pages that may be smaller than they are allowed to be.
#pragma once

#include "libatlas/pack/cells.h"
#include "libatlas/pack/engines.h"

namespace atlas::pack {

// The page reported for what is used of it, texels: cropped and rounded up as asked for.
Extent shaped_page(Extent used, const PackOptions& options);

// Width of a free page, cells: of a square that the items would fill to 95 %, but wide enough for
// each, and at most `most`.
std::int32_t square_width(const Problem& problem, std::int32_t most);

// Solves by the preset; a page that is free, or cropped and enough for all, also at other widths,
// of which the smallest page is taken.
Layout solve_shape(const Problem& problem, const PackOptions& options, const Context& context,
                   PackResult& result);

}  // namespace atlas::pack
