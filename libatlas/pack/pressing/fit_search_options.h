// Internal: what a caller that tries several ways to fit charts tells the search.
#pragma once

#include <cstdint>

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

}  // namespace atlas::pack
