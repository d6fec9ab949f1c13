// Internal: fits of charts to pages for callers that try several ways, and know from which fill on
// a page is of use to them, or what has been tried before.
#pragma once

#include <span>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/pressing/fit_search_options.h"

namespace atlas::pack {

// These do what fit_pages and fit_boxes_or_outlines do, and return the same errors. The members
// that FitOptions does not have are not checked.
Result<FitResult> search_fit(std::span<const FitItem> items, const FitSearchOptions& options,
                             const Context& context);
Result<FitResult> search_boxes_or_outlines(std::span<const FitItem> items,
                                           const FitSearchOptions& options, const Context& context);

// Does the last step of search_fit with press_pages for a fit to outlines that was made without it.
// `fitted` is the result of search_fit for the same items and options; of its placements, only the
// pages are used. Nothing is checked. Returns a denser fit if pressing finds one, otherwise
// `fitted`. Errors: cancelled.
Result<FitResult> press_fit(FitResult fitted, std::span<const FitItem> items,
                            const FitSearchOptions& options, const Context& context);

}  // namespace atlas::pack
