// Internal: the packing problem in whole cells, without padding, border and alignment.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/pack/pack.h"
#include "libatlas/pack/rectangles/free_rects.h"

namespace atlas::pack {

// All items have sides >= 1, and every item fits an empty page in some allowed direction.
struct Problem {
  std::span<const Extent> items;
  // The same items in texels, without padding. Only the sizes of cropped pages depend on them: with
  // an alignment, an item may end before its last cell does.
  std::span<const Extent> texels;
  Extent page;
  bool allow_rotation = false;
  // Whether strips of items that may be turned are also searched without turning any. A caller that
  // does this itself turns it off.
  bool search_unturned = true;
  std::uint32_t max_pages = kNoPage;
  // By page; may have fewer entries than there are pages.
  std::vector<std::vector<Rect>> pinned;
  // A caller that asks for a layout has to check this context as well, because packers that are
  // cancelled leave items out.
  const Context* context = nullptr;

  bool cancelled() const { return context && context->cancelled(); }

  std::span<const Rect> pinned_on(std::size_t page_id) const {
    return page_id < pinned.size() ? std::span<const Rect>(pinned[page_id])
                                   : std::span<const Rect>();
  }
};

// Number of items that packers place between two checks of the context; that takes a few hundredths
// of a second at most.
constexpr std::size_t kItemsAPoll = 1024;

struct Layout {
  std::vector<Placement> placements;  // one per item, in cells
  std::uint32_t pages = 0;            // number of pages that hold something
  std::uint32_t unplaced = 0;
  // The area that is filled on the last page, or the used height if there is a single page. A
  // smaller value is closer to a layout with one page less.
  std::int64_t last_used = 0;

  bool better_than(const Layout& other) const {
    if (unplaced != other.unplaced) return unplaced < other.unplaced;
    if (pages != other.pages) return pages < other.pages;
    return last_used < other.last_used;
  }
};

enum class Order { area, height, max_side, width, perimeter };

// Returns the item ids sorted in descending order of the key, then of the other sides, then in
// ascending order of the id.
std::vector<std::uint32_t> sorted_items(std::span<const Extent> items, Order order);

// Puts the items, in this order, into the first page that has room. Pages are lists of maximal free
// rectangles.
Layout pack_first_fit(const Problem& problem, std::span<const std::uint32_t> order, PlaceRule rule);

// Does the same with skylines and waste maps.
Layout pack_skyline(const Problem& problem, std::span<const std::uint32_t> order, PlaceRule rule);

}  // namespace atlas::pack
