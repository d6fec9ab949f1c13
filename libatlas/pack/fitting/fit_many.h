// Internal: fits many outlines to pages with few layouts.
#pragma once

#include <optional>

#include "libatlas/pack/fitting/fit_pages.h"

namespace atlas::pack {

// From this many charts a page on, few layouts at the right scale fill pages more than the search
// for the largest scale does, which has to make do with coarser cells. From fewer on, either may
// fill them more.
inline constexpr std::size_t kManyOnPage = 1000, kSomeOnPage = 129;

// Does fit_outlines for many charts. Charts such as triangles are joined in pairs, or copies of one
// chart in rows, whatever fills the pages more. The charts are dealt out evenly to strips as wide
// as a page, one per page. How high the strips become tells the scale at which they are as high as
// the pages, so a few layouts suffice. Where all charts fit at the largest scale, the pages are
// made neither smaller nor fewer. Returns nothing if some chart finds no room, or if the context is
// cancelled.
std::optional<FitResult> fit_many(const FitCharts& charts, const FitSearchOptions& options,
                                  const Context& context);

}  // namespace atlas::pack
