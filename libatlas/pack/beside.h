// Places outlines on pages beside others that stay where they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/outline.h"
#include "libatlas/pack/pages.h"

namespace atlas {

// A shape that lies on a page already. Its corners are in texels of that page, origin bottom left;
// what lies beyond the page counts for nothing.
struct TakenShape {
  std::uint32_t page = 0;
  ChartShape shape = {};
};

struct TakenPages {
  std::span<const Extent> pages = {};  // texels, sides of 1 .. 16384
  std::span<const TakenShape> shapes = {};
};

struct BesideResult {
  std::vector<OutlinePlacement> placements = {};  // one per shape, all placed
  // The given pages, which may have grown to the right and to the top, so that what lies on them
  // keeps its texels; and pages that were added.
  std::vector<Extent> pages = {};
};

// Places the shapes, whose corners are in texels of the pages, in the free room of the pages, as
// pack_outlines() keeps shapes apart. Larger ones come first, each goes where it ends lowest, on
// the first page that has room. If there is none, pages of the last one's size are added as long as
// there are fewer than options.pages. After that pages grow: all by a factor of two if they are
// `square`, else the last one only, in height or, up to the longest side of 16384, in width. Of the
// other options, padding, alignment and allow_rotation count; page_size does not. The result is the
// same for every thread count.
// Errors: bad_input (as for pack_outlines(), no page, or a page that a taken shape names and that
// is not there); bad_option; no_solution (pages would have to be larger than 16384); cancelled.
Result<BesideResult> pack_beside(std::span<const ChartShape> shapes, const TakenPages& taken,
                                 const PageOptions& options, const Context& context);

}  // namespace atlas
