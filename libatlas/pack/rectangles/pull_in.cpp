#include "libatlas/pack/rectangles/pull_in.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "libatlas/core/sort_total.h"

namespace atlas::pack {
namespace {

// How far the items that have been moved reach along the axis of movement. This is a function of
// the position across that axis, and it is constant between its keys.
class Front {
 public:
  // Puts an item of this depth onto the front between two positions. Returns where the item begins.
  std::int32_t put(std::int32_t begin, std::int32_t end, std::int32_t depth) {
    const auto last = split(end);
    std::int32_t reach = 0;
    for (auto at = split(begin); at != last; at = ends_.erase(at))
      reach = std::max(reach, at->second);
    ends_.emplace_hint(last, begin, reach + depth);
    return reach;
  }

 private:
  using Ends = std::map<std::int32_t, std::int32_t>;

  // Makes the position a key, and returns its entry.
  Ends::iterator split(std::int32_t position) {
    const auto next = ends_.lower_bound(position);
    if (next != ends_.end() && next->first == position) return next;
    return ends_.emplace_hint(next, position, std::prev(next)->second);
  }

  Ends ends_{{-1, 0}};  // every position has a key below it
};

// The items of one page, and their order along one axis.
class PagePuller {
 public:
  PagePuller(const Problem& problem, Layout& layout, std::vector<std::uint32_t> ids)
      : problem_(problem), layout_(layout), ids_(std::move(ids)) {}

  // Returns the share of the page that the items fill, up to the last ones to the right and above.
  double fill() const {
    std::int32_t width = 0, height = 0;
    double area = 0;
    for (const std::uint32_t id : ids_) {
      const Placement& at = layout_.placements[id];
      const Extent item = problem_.items[id];
      width = std::max(width, at.x + (at.rotated ? item.height : item.width));
      height = std::max(height, at.y + (at.rotated ? item.width : item.height));
      area += static_cast<double>(item.area());
    }
    return area / (static_cast<double>(width) * height);
  }

  // Moves all items left, or down. Those that begin nearer to the edge come first. What lies
  // between an item and the edge has then been moved already, and not away from the edge, so no
  // item has to give way. Returns whether an item has moved.
  bool pull(std::int32_t Placement::*along, std::int32_t Placement::*across) {
    sort_total(ids_.begin(), ids_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const Placement &p = layout_.placements[a], &q = layout_.placements[b];
      return std::pair(p.*along, a) < std::pair(q.*along, b);
    });
    Front front;
    bool moved = false;
    for (const std::uint32_t id : ids_) {
      Placement& at = layout_.placements[id];
      Extent size = problem_.items[id];
      if (at.rotated != (along == &Placement::y)) std::swap(size.width, size.height);
      // Now the width is the item's extent along the axis, its height the one across.
      const std::int32_t to = front.put(at.*across, at.*across + size.height, size.width);
      moved |= to < at.*along;
      at.*along = to;
    }
    return moved;
  }

 private:
  const Problem& problem_;
  Layout& layout_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace

void pull_in(const Problem& problem, Layout& layout) {
  constexpr int kMostRounds = 4;
  constexpr std::size_t kMany = 1000;
  constexpr double kFull = 0.98;
  std::vector<std::vector<std::uint32_t>> pages;
  for (std::uint32_t i = 0; i < layout.placements.size(); ++i) {
    const std::uint32_t page = layout.placements[i].page;
    if (page == kNoPage) continue;
    if (page >= pages.size()) pages.resize(page + 1);
    pages[page].push_back(i);
  }
  for (std::vector<std::uint32_t>& ids : pages) {
    if (ids.empty()) continue;
    const bool many = ids.size() > kMany;
    PagePuller page(problem, layout, std::move(ids));
    if (many && page.fill() >= kFull) continue;
    for (int round = 0; round < kMostRounds; ++round) {
      const bool left = page.pull(&Placement::x, &Placement::y);
      if (round > 0 && !left) break;
      if (!page.pull(&Placement::y, &Placement::x)) break;
    }
  }
}

}  // namespace atlas::pack
