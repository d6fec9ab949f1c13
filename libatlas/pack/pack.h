// Packs rectangles into pages. It works on integers only, so charts, images and sprites are all the
// same to it.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/rect.h"
#include "libatlas/core/status.h"

namespace atlas {

struct Extent {
  std::int32_t width = 0, height = 0;
  std::int64_t area() const { return std::int64_t{width} * height; }
  bool operator==(const Extent&) const = default;
};

inline constexpr std::uint32_t kNoPage = std::numeric_limits<std::uint32_t>::max();

// The place of an item. The item covers [x, x + width) × [y, y + height) of its page. If `rotated`
// is set, the item is turned a quarter counterclockwise, and its width and height are swapped.
struct Placement {
  std::uint32_t page = kNoPage;  // kNoPage: the item was not placed
  std::int32_t x = 0, y = 0;
  bool rotated = false;
  bool placed() const { return page != kNoPage; }
  bool operator==(const Placement&) const = default;
};

enum class PackPreset {
  fast,      // fills the gaps of the skyline in one pass, widest item first: O(n log n)
  standard,  // up to 1000 items: local search with a small, fixed effort; more: the best of a few
             // passes of the gap, free-rectangle and skyline engines
  best,      // local search over orders until a time or effort budget is spent
};

// Which packer does the work. With `automatic` the preset decides.
enum class PackEngine {
  automatic,
  skyline_bottom_left,  // first fit by height over skylines with waste maps; takes the lowest place
  skyline_min_waste,    // the same, but takes the place that buries the least area
  max_rects,            // first fit by height over lists of maximal free rectangles
};

// A rectangle that must stay where it is. Nothing else is put there. It may lie anywhere in a page.
struct PinnedRect {
  std::uint32_t page = 0;
  Rect rect = {};
};

struct PackOptions {
  // Largest page, in texels; each side is in 1 .. 2^30 - padding. If the height is 0, there is one
  // page of open height (a strip), and its used height is made small. If both sides are 0, there is
  // one page that is free in both directions, and it is made nearly square. An open side is limited
  // to 2^30 - padding, too.
  Extent page{2048, 2048};
  std::uint32_t max_pages = 0;  // 0: as many as needed
  bool allow_rotation = false;  // allows quarter turns
  std::int32_t padding = 0;     // free texels between any two items; 0 .. 2^24
  std::int32_t border = 0;      // free texels along the page's edges; 0 .. 2^24
  // Items begin at multiples of this, counted from the page's corner; 1 .. 2^24. Sides of cropped
  // and open pages are multiples of it, too, unless the largest page has no room for that.
  std::int32_t alignment = 1;
  // The shape of the pages that the result reports: each is cut to what is used and then rounded
  // up.
  bool crop = false;  // false: pages keep the size `page`
  // Each side is rounded up to a power of two; the sides of `page` must be powers of two.
  bool power_of_two = false;
  bool square = false;
  PackPreset preset = PackPreset::standard;
  PackEngine engine = PackEngine::automatic;
  // Limits of `best`. As long as the time limit is not reached, the result depends on effort and
  // seed only, never on the thread count.
  double time_budget = 1.0;  // wall time in seconds; infinity is allowed
  std::uint64_t effort = 0;  // maximum number of layouts that are tried; 0: no limit
  std::uint64_t seed = 1;
  std::span<const PinnedRect> pinned = {};
};

enum class UnplacedReason { too_large, no_room };

struct UnplacedItem {
  std::uint32_t item = 0;
  UnplacedReason reason = UnplacedReason::no_room;
};

struct PackResult {
  std::vector<Placement> placements = {};   // one per item, in input order
  std::vector<Extent> pages = {};           // the size of every page used
  std::vector<UnplacedItem> unplaced = {};  // every item that was not placed, ascending by item
  std::int64_t placed_area = 0;  // area of the placed items without padding, in square texels
  double utilization = 0;        // placed_area / total area of the pages
  double fill_without_last = 0;  // the same without the last page; 1 if there is only one page
  // No packing of all items that are not too large needs fewer pages than this. With `fast` and
  // with pinned rectangles it follows from the items' area alone. A strip has 1.
  std::uint32_t page_lower_bound = 0;
  std::uint64_t layouts_tried = 0;
};

// Packs the items into pages. The placements are in input order, and ties are broken by index. An
// item with a side of 0 takes no space and is reported at the corner of page 0. An item that is
// larger than the page (border included) is unplaced as too_large, and so is one with a side of 0
// if the borders and the alignment leave no such corner. An item that finds no free place, because
// of max_pages or pinned rectangles, is unplaced as no_room. Negative sides are bad_input. So are
// items whose total area exceeds 2^62 square texels, or 2^62 cells of alignment × alignment texels
// with their padding; items that are too large do not count. Sources: Jylänki 2010 (skyline, waste
// map, maximal rectangles), Burke et al. 2004 (best fit), Wei et al. 2011 and Leung et al. 2011
// (skyline scores, local search); docs/packing.md. Errors: bad_option, bad_input, cancelled.
Result<PackResult> pack_rects(std::span<const Extent> items, const PackOptions& options,
                              const Context& context);

}  // namespace atlas
