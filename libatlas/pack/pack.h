// Packing rectangles into pages. Knows integers only: charts, images and sprites look alike here.
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

// Where an item went. The item covers [x, x + width) × [y, y + height) of its page, with width and
// height swapped if rotated (a quarter turn counterclockwise).
struct Placement {
  std::uint32_t page = kNoPage;  // kNoPage: not placed
  std::int32_t x = 0, y = 0;
  bool rotated = false;
  bool placed() const { return page != kNoPage; }
  bool operator==(const Placement&) const = default;
};

enum class PackPreset {
  fast,      // one pass over the gaps of the skyline, widest item first: O(n log n)
  standard,  // the better of a few passes of free-rectangle and skyline engines within a small
             // effort
  best,      // standard, then local search over orders until a time or effort budget is spent
};

// Which packer does the work; automatic lets the preset choose.
enum class PackEngine {
  automatic,
  skyline_bottom_left,  // first fit by height over skylines with waste maps, lowest place first
  skyline_min_waste,    // the same, place with the least buried area first
  max_rects,            // first fit by height over lists of maximal free rectangles
};

// A rectangle that must stay where it is. Nothing else is put there; it may lie anywhere in a page.
struct PinnedRect {
  std::uint32_t page = 0;
  Rect rect;
};

struct PackOptions {
  // Largest page, texels (1 .. 2^30 less the padding). height 0: one page of open height (a strip)
  // whose used height is made small. Both 0: one page, free in both directions, made nearly square.
  // An open side is at most that long, too.
  Extent page{2048, 2048};
  std::uint32_t max_pages = 0;  // 0: as many as it takes
  bool allow_rotation = false;  // quarter turns
  std::int32_t padding = 0;     // free texels between any two items, >= 0
  std::int32_t border = 0;      // free texels along the page's edges, >= 0
  std::int32_t alignment = 1;   // items begin at multiples of this (from the page's corner), >= 1
  // Shape of the pages reported in the result: cut to what is used, then rounded up.
  bool crop = false;          // false: pages keep the size `page`
  bool power_of_two = false;  // each side rounded up to a power of two (needs page sides to be)
  bool square = false;
  PackPreset preset = PackPreset::standard;
  PackEngine engine = PackEngine::automatic;
  // Limits of `best`. The result depends on effort and seed only, never on the thread count, as
  // long as the time limit does not strike first.
  double time_budget = 1.0;  // wall seconds; infinity allowed
  std::uint64_t effort = 0;  // layouts tried at most; 0: no limit
  std::uint64_t seed = 1;
  std::span<const PinnedRect> pinned;
};

enum class UnplacedReason { too_large, no_room };

struct UnplacedItem {
  std::uint32_t item = 0;
  UnplacedReason reason = UnplacedReason::no_room;
};

// A point of the curve of density against effort.
struct PackProgress {
  double seconds = 0;         // wall time since the start
  std::uint64_t layouts = 0;  // tried so far
  std::uint32_t pages = 0;
  std::int64_t used_height = 0;  // of the last page
};

struct PackResult {
  std::vector<Placement> placements;   // 1 an item, in input order
  std::vector<Extent> pages;           // size of every page used
  std::vector<UnplacedItem> unplaced;  // counted and named, ascending by item
  std::int64_t placed_area = 0;        // texels² of the items, without padding
  double utilization = 0;              // placed_area / total area of the pages
  double fill_without_last = 0;        // the same without the last page; 1 if there is only one
  std::uint32_t page_lower_bound = 0;  // no packing needs fewer pages than this
  std::uint64_t layouts_tried = 0;
  std::vector<PackProgress> curve;  // improvements in the order found
};

// Packs the items into pages. Input order is kept; ties are broken by index.
// Degenerate items: a side of 0 takes no room and is reported at the corner of page 0; an item
// larger than the page (border included) is unplaced, too_large; with max_pages or pinned
// rectangles exhausted it is unplaced, no_room. Negative sides are bad_input, and so are items of
// more than 2^62 texels² together, or with their padding, but for those that are too large.
// Sources: Jylänki 2010 (skyline, waste map, maximal rectangles), Burke et al. 2004 (best fit),
// Wei et al. 2011 and Leung et al. 2011 (skyline scores, local search); docs/packing.md.
// Errors: bad_option, bad_input, cancelled.
Result<PackResult> pack_rects(std::span<const Extent> items, const PackOptions& options,
                              const Context& context);

}  // namespace atlas
