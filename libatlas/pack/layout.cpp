#include "libatlas/pack/layout.h"

#include <fmt/format.h>

#include "libatlas/pack/rectangles/cells.h"
#include "libatlas/pack/rectangles/free_rects.h"
#include "libatlas/pack/rectangles/page_index.h"

namespace atlas {

using pack::AlignedCells;
using pack::FreeRects;

struct AtlasLayout::State {
  explicit State(const PackOptions& o)
      : options(o), pins(o.pinned.begin(), o.pinned.end()), cells(options) {
    options.pinned = pins;
    page = {cells.page(options.page.width), cells.page(options.page.height)};
  }

  struct Item {
    Extent size;
    Placement at;  // texels
    bool present = false;
  };

  Rect box_of(const Item& item) const {
    Extent e = item.size;
    if (item.at.rotated) std::swap(e.width, e.height);
    return {cells.cell(item.at.x), cells.cell(item.at.y),
            static_cast<std::int32_t>(cells.item(e.width)),
            static_cast<std::int32_t>(cells.item(e.height))};
  }

  FreeRects fresh_page(std::uint32_t p) const {
    FreeRects free(page);
    for (const PinnedRect& pin : pins) {
      if (pin.page != p) continue;
      // One without area takes no space, as in pack_rects.
      if (const Rect taken = cells.pinned(pin.rect, page); taken.area() > 0) free.block(taken);
    }
    return free;
  }

  // Makes the free rectangles of a page from its items.
  void rebuild(std::uint32_t p) {
    pages[p] = fresh_page(p);
    for (std::uint32_t id : on_page[p]) pages[p].place(box_of(items[id]));
    index.update(p, pages[p].room());
  }

  void open_page() {
    const auto p = static_cast<std::uint32_t>(pages.size());
    pages.push_back(fresh_page(p));
    on_page.emplace_back();
    index.push_back(pages.back().room());
  }

  PackOptions options;
  std::vector<PinnedRect> pins;
  AlignedCells cells;
  Extent page;  // cells
  std::vector<Item> items;
  std::size_t present = 0;
  std::vector<FreeRects> pages;
  std::vector<std::vector<std::uint32_t>> on_page;  // ids of the items with area, by page
  pack::PageIndex index;
};

AtlasLayout::AtlasLayout(std::unique_ptr<State> state) : state_(std::move(state)) {}
AtlasLayout::AtlasLayout(AtlasLayout&&) noexcept = default;
AtlasLayout& AtlasLayout::operator=(AtlasLayout&&) noexcept = default;
AtlasLayout::~AtlasLayout() = default;

Result<AtlasLayout> AtlasLayout::create(const PackOptions& options) {
  if (options.page.width < 1 || options.page.height < 1)
    return Status(ErrorCode::bad_option, "layout: both sides of the page must be given");
  // pack_rects checks the options and describes the error.
  if (Result<PackResult> checked = pack_rects({}, options, {}); !checked.ok())
    return checked.status();
  return AtlasLayout(std::make_unique<State>(options));
}

Result<std::uint32_t> AtlasLayout::insert(Extent item) {
  State& s = *state_;
  if (item.width < 0 || item.height < 0)
    return Status(ErrorCode::bad_input, fmt::format("layout: an item is {} x {} (sides must not be "
                                                    "negative)",
                                                    item.width, item.height));
  const auto id = static_cast<std::uint32_t>(s.items.size());
  const bool area = item.area() > 0;
  if (!area && s.cells.has_corner(s.options.page)) {
    s.items.push_back({item, {0, s.cells.corner(), s.cells.corner(), false}, true});
    ++s.present;
    return id;
  }
  const std::int64_t w = s.cells.item(item.width), h = s.cells.item(item.height);
  const bool fits = (w <= s.page.width && h <= s.page.height) ||
                    (s.options.allow_rotation && h <= s.page.width && w <= s.page.height);
  if (!area || !fits)
    return Status(ErrorCode::no_solution,
                  fmt::format("layout: an item of {} x {} is larger than the page (use pages of at "
                              "least that size)",
                              item.width, item.height));
  const Extent cells{static_cast<std::int32_t>(w), static_cast<std::int32_t>(h)};
  const std::uint32_t limit = s.options.max_pages ? s.options.max_pages : kNoPage;
  for (std::size_t p = 0;; ++p) {
    p = s.index.next(p, cells, s.options.allow_rotation);
    if (p == s.pages.size()) {
      if (p >= limit)
        return Status(ErrorCode::no_solution,
                      fmt::format("layout: no room for an item of {} x {} in {} pages (allow more, "
                                  "or repack)",
                                  item.width, item.height, limit));
      s.open_page();
    }
    pack::Spot spot;
    if (!s.pages[p].find(cells, s.options.allow_rotation, pack::PlaceRule::bottom_left, spot))
      continue;
    s.pages[p].place(spot.rect);
    s.index.update(p, s.pages[p].room());
    s.on_page[p].push_back(id);
    s.items.push_back({item,
                       {static_cast<std::uint32_t>(p), s.cells.texel(spot.rect.x),
                        s.cells.texel(spot.rect.y), spot.rotated},
                       true});
    ++s.present;
    return id;
  }
}

bool AtlasLayout::remove(std::uint32_t id) {
  if (!contains(id)) return false;
  State& s = *state_;
  State::Item& item = s.items[id];
  item.present = false;
  --s.present;
  if (item.size.area() == 0) return true;
  const std::uint32_t page = item.at.page;
  std::erase(s.on_page[page], id);
  s.pages[page].take_away(s.box_of(item));
  s.index.update(page, s.pages[page].room());
  return true;
}

Status AtlasLayout::repack(const Context& context) {
  State& s = *state_;
  std::vector<std::uint32_t> ids;
  std::vector<Extent> sizes;
  for (std::uint32_t id = 0; id < s.items.size(); ++id)
    if (s.items[id].present) {
      ids.push_back(id);
      sizes.push_back(s.items[id].size);
    }
  Result<PackResult> packed = pack_rects(sizes, s.options, context);
  if (!packed.ok()) return packed.status();
  if (!packed->unplaced.empty())
    return {
        ErrorCode::no_solution,
        fmt::format("layout: packed anew, {} items would have no room (the layout is unchanged)",
                    packed->unplaced.size())};
  s.pages.clear();
  s.on_page.clear();
  s.index = {};
  for (std::size_t k = 0; k < ids.size(); ++k) {
    State::Item& item = s.items[ids[k]];
    item.at = packed->placements[k];
    if (item.size.area() == 0) continue;
    while (s.pages.size() <= item.at.page) s.open_page();
    s.on_page[item.at.page].push_back(ids[k]);
  }
  for (std::uint32_t p = 0; p < s.pages.size(); ++p) s.rebuild(p);
  return {};
}

std::size_t AtlasLayout::size() const {
  return state_->present;
}

bool AtlasLayout::contains(std::uint32_t id) const {
  return id < state_->items.size() && state_->items[id].present;
}

Extent AtlasLayout::extent(std::uint32_t id) const {
  assert(contains(id));
  return state_->items[id].size;
}

Placement AtlasLayout::placement(std::uint32_t id) const {
  assert(contains(id));
  return state_->items[id].at;
}

std::uint32_t AtlasLayout::page_count() const {
  for (auto p = static_cast<std::uint32_t>(state_->on_page.size()); p > 0; --p)
    if (!state_->on_page[p - 1].empty()) return p;
  return 0;
}

double AtlasLayout::utilization() const {
  double area = 0;
  for (const auto& page : state_->on_page)
    for (std::uint32_t id : page) area += static_cast<double>(state_->items[id].size.area());
  const double pages = static_cast<double>(state_->options.page.area()) * page_count();
  return pages > 0 ? area / pages : 0;
}

}  // namespace atlas
