// Internal: fits outlines to a page of any shape at a given scale.
#pragma once

#include "libatlas/pack/fitting/fit_pages.h"

namespace atlas::pack {

// Does fit_outlines. If all charts fit a single page of any shape at the largest scale, with room
// to spare, a smaller page is looked for that they fill at this scale. Without this, the layout
// would be a row along the side of a large page.
Result<FitResult> fit_outlines_at_most(const FitCharts& charts, const FitSearchOptions& options,
                                       const Context& context);

}  // namespace atlas::pack
