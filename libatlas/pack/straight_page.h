// Internal: charts whose sides are straight, on one page of any shape.
#pragma once

#include <span>

#include "libatlas/pack/press.h"

namespace atlas::pack {

// Whether the charts' outlines run along their frames, as machine parts' do: such charts lie
// closest side by side, turned by right angles only.
bool is_straight(std::span<const ChartOutline> outlines);

// Layouts on cells for several scales, then every chart slid down and to the left on exact masks.
// No side of the page exceeds options.page_size. For options.free_aspect; the options have been
// checked.
PressedPage pack_straight(std::span<const ChartOutline> outlines, const FitOptions& options,
                          const Context& context);

}  // namespace atlas::pack
