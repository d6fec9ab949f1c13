// Internal: the packing problem in whole cells, after padding, border and alignment are taken out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/pack/free_rects.h"
#include "libatlas/pack/pack.h"

namespace atlas::pack {

// Sides of all items are >= 1 and every item fits an empty page in some allowed direction.
struct Problem {
  std::span<const Extent> items;
  Extent page;
  bool allow_rotation = false;
  std::uint32_t max_pages = kNoPage;
  std::vector<std::vector<Rect>> pinned;  // by page; may be shorter than the number of pages
  // Whoever asks for a layout has to ask it as well: packers that are cancelled leave items out.
  const Context* context = nullptr;

  bool cancelled() const { return context && context->cancelled(); }

  std::span<const Rect> pinned_on(std::size_t page_id) const {
    return page_id < pinned.size() ? std::span<const Rect>(pinned[page_id])
                                   : std::span<const Rect>();
  }
};

// Items that packers place between two looks at the context: a few hundredths of a second at most.
constexpr std::size_t kItemsAPoll = 1024;

struct Layout {
  std::vector<Placement> placements;  // 1 an item, cells
  std::uint32_t pages = 0;            // pages that hold something
  std::uint32_t unplaced = 0;
  std::int64_t last_used = 0;  // area on the fullest-to-emptiest last page, or used height of
                               // a single page: smaller is closer to doing without

  bool better_than(const Layout& other) const {
    if (unplaced != other.unplaced) return unplaced < other.unplaced;
    if (pages != other.pages) return pages < other.pages;
    return last_used < other.last_used;
  }
};

enum class Order { area, height, max_side, width, perimeter };

// Item ids sorted descending by the key, then by the other sides, then by id.
std::vector<std::uint32_t> sorted_items(std::span<const Extent> items, Order order);

// Every item, in this order, into the first page with room, by maximal free rectangles.
Layout pack_first_fit(const Problem& problem, std::span<const std::uint32_t> order, PlaceRule rule);

// The same by skylines with waste maps.
Layout pack_skyline(const Problem& problem, std::span<const std::uint32_t> order, PlaceRule rule);

}  // namespace atlas::pack
