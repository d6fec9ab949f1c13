// Internal: fits many outlines to a page of any shape with few layouts.
#pragma once

#include <optional>

#include "libatlas/pack/fit_pages.h"

namespace atlas::pack {

// From this many charts on, layouts at the right scale fill a page of any shape more than the
// search for the largest scale does, which has to make do with coarser cells. From fewer on, either
// may fill it more, so both are tried.
inline constexpr std::size_t kManyOnFreePage = 1000, kSomeOnFreePage = 129;

// Does fit_outlines with free_aspect for one page. Charts such as triangles are joined in pairs.
// Since the page ends where the charts do, no scale is searched for: a strip is filled once or
// twice to learn the scale at which it becomes a square of page_size. Returns nothing if some chart
// finds no room, or if the context is cancelled.
std::optional<FitResult> fit_free_page(const FitCharts& charts, const FitOptions& options,
                                       const Context& context);

}  // namespace atlas::pack
