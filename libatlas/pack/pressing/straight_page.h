// Internal: packs charts whose sides are straight on one page of any shape.
#pragma once

#include <span>

#include "libatlas/pack/pressing/press.h"

namespace atlas::pack {

// Returns whether the charts' outlines run mostly along the axes of their frames, like those of
// machine parts. Such charts are packed most densely side by side, turned by right angles only.
bool is_straight(std::span<const ChartOutline> outlines);

// Makes layouts on cells for several scales, and then slides every chart down and to the left on
// exact masks. No side of the page exceeds options.page_size. This is for options.free_aspect. The
// options must have been checked.
PressedPage pack_straight(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                          const Context& context);

}  // namespace atlas::pack
