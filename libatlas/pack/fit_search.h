// Internal: fits of charts to pages for callers that try several ways, and know from which fill on
// a page is of use to them, or what has been tried before.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/fit.h"

namespace atlas::pack {

struct FitSearchOptions : FitOptions {
  // A single page that is filled less than this share is of no use to the caller. So the search for
  // a layout of outlines ends early if the page is far emptier after the first draws. If charts are
  // laid in rows and `best` has an effort, it also ends if the page is still below this share after
  // a further round. Several pages are no longer pressed once they are unlikely to become so full.
  // 0: the search is as long as usual.
  double wanted_fill = 0;
  // For `best` on a single page of outlines that is pressed or laid in rows: the number of layouts
  // that `standard` has already tried for the same items. They count as effort, and whatever would
  // only repeat them is left out.
  std::uint64_t tried = 0;
};

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
