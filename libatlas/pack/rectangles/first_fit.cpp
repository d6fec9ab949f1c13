#include <algorithm>
#include <array>

#include "libatlas/core/sort_total.h"
#include "libatlas/pack/rectangles/height_index.h"
#include "libatlas/pack/rectangles/page_index.h"
#include "libatlas/pack/rectangles/problem.h"
#include "libatlas/pack/rectangles/skyline.h"

namespace atlas::pack {
namespace {

std::array<std::int64_t, 3> sort_key(Extent e, Order order) {
  switch (order) {
    case Order::area:
      return {e.area(), e.height, e.width};
    case Order::height:
      return {e.height, e.width, 0};
    case Order::width:
      return {e.width, e.height, 0};
    case Order::max_side:
      return {std::max(e.width, e.height), std::min(e.width, e.height), e.height};
    case Order::perimeter:
      return {std::int64_t{e.width} + e.height, std::max(e.width, e.height), e.height};
  }
  return {};
}

// The smallest sides among the items that are not yet placed. Free rectangles that are too small
// for all of these items can be removed, which keeps the lists short.
class RemainingMinimum {
 public:
  RemainingMinimum(const Problem& problem, std::span<const std::uint32_t> order) {
    suffix_.resize(order.size() + 1, {INT32_MAX, INT32_MAX});
    for (std::size_t i = order.size(); i-- > 0;) {
      Extent e = problem.items[order[i]];
      if (problem.allow_rotation) e.width = e.height = std::min(e.width, e.height);
      suffix_[i] = {std::min(e.width, suffix_[i + 1].width),
                    std::min(e.height, suffix_[i + 1].height)};
    }
  }
  Extent from(std::size_t i) const { return suffix_[i]; }

 private:
  std::vector<Extent> suffix_;
};

}  // namespace

std::vector<std::uint32_t> sorted_items(std::span<const Extent> items, Order order) {
  struct Keyed {
    std::array<std::int64_t, 3> key;
    std::uint32_t id;
  };
  std::vector<Keyed> keyed(items.size());
  for (std::size_t i = 0; i < items.size(); ++i)
    keyed[i] = {sort_key(items[i], order), static_cast<std::uint32_t>(i)};
  sort_total(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return a.key != b.key ? a.key > b.key : a.id < b.id;
  });
  std::vector<std::uint32_t> ids(items.size());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = keyed[i].id;
  return ids;
}

namespace {

template <class Page>
void count_pages(const std::vector<Page>& pages, Layout& layout) {
  for (std::size_t p = 0; p < pages.size(); ++p)
    if (!pages[p].empty()) layout.pages = static_cast<std::uint32_t>(p + 1);
  if (layout.pages == 1)
    layout.last_used = pages[0].used_height();
  else if (layout.pages > 1)
    layout.last_used = pages[layout.pages - 1].filled();
}

template <class Page>
Layout first_fit(const Problem& problem, std::span<const std::uint32_t> order, PlaceRule rule) {
  Layout layout;
  layout.placements.resize(problem.items.size());
  const RemainingMinimum remaining(problem, order);
  std::vector<Page> pages;
  PageIndex index;
  const auto open_page = [&](Extent smallest) {
    Page page(problem.page);
    page.drop_smaller(smallest.width, smallest.height);
    for (const Rect& pin : problem.pinned_on(pages.size())) page.block(pin);
    index.push_back(page.room());
    pages.push_back(std::move(page));
  };
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i % kItemsAPoll == 0 && problem.cancelled()) {
      layout.unplaced += static_cast<std::uint32_t>(order.size() - i);
      break;
    }
    const Extent item = problem.items[order[i]];
    const Extent smallest = remaining.from(i);
    for (std::size_t at = 0;; ++at) {
      at = index.next(at, item, problem.allow_rotation);
      if (at == pages.size()) {
        // Pages are opened until one has room. If no pinned rectangle lies on it, the first new
        // page has.
        if (pages.size() >= problem.max_pages) break;
        open_page(smallest);
      }
      Spot spot;
      if (!pages[at].find(item, problem.allow_rotation, rule, spot)) continue;
      pages[at].place(spot.rect);
      pages[at].drop_smaller(smallest.width, smallest.height);
      index.update(at, pages[at].room());
      layout.placements[order[i]] = {static_cast<std::uint32_t>(at), spot.rect.x, spot.rect.y,
                                     spot.rotated};
      break;
    }
    layout.unplaced += !layout.placements[order[i]].placed();
  }
  count_pages(pages, layout);
  return layout;
}

// Does the same for items that come in descending order of height. The room of each page is then
// known exactly.
Layout first_fit_falling(const Problem& problem, std::span<const std::uint32_t> order) {
  Layout layout;
  layout.placements.resize(problem.items.size());
  const RemainingMinimum remaining(problem, order);
  std::vector<FreeRects> pages;
  HeightIndex index;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i % kItemsAPoll == 0 && problem.cancelled()) {
      layout.unplaced += static_cast<std::uint32_t>(order.size() - i);
      break;
    }
    const Extent item = problem.items[order[i]], smallest = remaining.from(i);
    index.sink(item.height, pages);
    std::size_t at = index.first(item.width);
    while (at == pages.size() && pages.size() < problem.max_pages) {
      pages.emplace_back(problem.page);
      pages.back().drop_smaller(smallest.width, smallest.height);
      for (const Rect& pin : problem.pinned_on(at)) pages.back().block(pin);
      index.push_back(pages.back());
      at = index.first(item.width);
    }
    Spot spot;
    if (at == pages.size() || !pages[at].find(item, false, PlaceRule::bottom_left, spot)) {
      ++layout.unplaced;
      continue;
    }
    pages[at].place(spot.rect);
    pages[at].drop_smaller(smallest.width, smallest.height);
    index.update(at, pages[at]);
    layout.placements[order[i]] = {static_cast<std::uint32_t>(at), spot.rect.x, spot.rect.y, false};
  }
  count_pages(pages, layout);
  return layout;
}

}  // namespace

Layout pack_first_fit(const Problem& problem, std::span<const std::uint32_t> order,
                      PlaceRule rule) {
  const bool falling = std::is_sorted(order.begin(), order.end(), [&](auto a, auto b) {
    return problem.items[a].height > problem.items[b].height;
  });
  if (falling && !problem.allow_rotation && rule == PlaceRule::bottom_left)
    return first_fit_falling(problem, order);
  return first_fit<FreeRects>(problem, order, rule);
}

Layout pack_skyline(const Problem& problem, std::span<const std::uint32_t> order, PlaceRule rule) {
  return first_fit<Skyline>(problem, order, rule);
}

}  // namespace atlas::pack
