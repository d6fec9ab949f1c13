#include <algorithm>
#include <array>
#include <bit>

#include "libatlas/core/sort_total.h"
#include "libatlas/pack/rectangles/engines.h"
#include "libatlas/pack/rectangles/gap_heap.h"

namespace atlas::pack {
namespace {

// Items in both allowed directions, sorted by width. Finds the widest item that fits a gap.
class WidestFit {
 public:
  explicit WidestFit(const Problem& problem) {
    for (std::uint32_t i = 0; i < problem.items.size(); ++i) {
      const Extent e = problem.items[i];
      entries_.push_back({e, i, false});
      if (problem.allow_rotation && e.width != e.height)
        entries_.push_back({{e.height, e.width}, i, true});
    }
    sort_total(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      if (a.size.width != b.size.width) return a.size.width < b.size.width;
      if (a.size.height != b.size.height) return a.size.height < b.size.height;
      return a.item != b.item ? a.item > b.item : a.rotated > b.rotated;
    });
    // One spare leaf, because find() starts behind the last entry.
    leaves_ = std::bit_ceil(entries_.size() + 1);
    lowest_.assign(2 * leaves_, kGone);
    other_.assign(problem.items.size(), {kNone, kNone});
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      lowest_[leaves_ + k] = entries_[k].size.height;
      other_[entries_[k].item][entries_[k].rotated] = k;
    }
    for (std::size_t n = leaves_ - 1; n >= 1; --n)
      lowest_[n] = std::min(lowest_[2 * n], lowest_[2 * n + 1]);
  }

  struct Entry {
    Extent size;
    std::uint32_t item;
    bool rotated;
  };

  // Returns the widest item (ties: the tallest, then the smallest id) that is no larger than the
  // room; null if there is none.
  const Entry* find(Extent room) const {
    const auto after =
        std::upper_bound(entries_.begin(), entries_.end(), room.width,
                         [](std::int32_t width, const Entry& e) { return width < e.size.width; });
    std::size_t node = leaves_ + static_cast<std::size_t>(after - entries_.begin());
    // Goes up from the end of the range until a subtree to the left holds an item that is low
    // enough, then down into it.
    while (node > 1) {
      if ((node & 1) && lowest_[node - 1] <= room.height) {
        --node;
        while (node < leaves_) node = 2 * node + (lowest_[2 * node + 1] <= room.height);
        return &entries_[node - leaves_];
      }
      node /= 2;
    }
    return nullptr;
  }

  void remove(std::uint32_t item) {
    for (std::size_t k : other_[item]) {
      if (k == kNone) continue;
      std::size_t node = leaves_ + k;
      lowest_[node] = kGone;
      for (node /= 2; node >= 1; node /= 2)
        lowest_[node] = std::min(lowest_[2 * node], lowest_[2 * node + 1]);
    }
  }

  std::int32_t lowest() const { return lowest_[1]; }
  static constexpr std::int32_t kGone = INT32_MAX;

 private:
  static constexpr std::size_t kNone = SIZE_MAX;
  std::vector<Entry> entries_;
  std::size_t leaves_ = 0;
  std::vector<std::int32_t> lowest_;  // a tree: the smallest height among the remaining items
  std::vector<std::array<std::size_t, 2>> other_;
};

}  // namespace

Layout pack_widest_first(const Problem& problem) {
  Layout layout;
  layout.placements.resize(problem.items.size());
  layout.unplaced = static_cast<std::uint32_t>(problem.items.size());
  if (problem.cancelled()) return layout;  // before the items are sorted
  WidestFit fit(problem);
  std::size_t left = problem.items.size();
  std::vector<std::int64_t> filled;
  std::int32_t used = 0;
  for (; left > 0 && layout.pages < problem.max_pages && !problem.cancelled(); ++layout.pages) {
    GapHeap gaps(problem.page);
    filled.push_back(0);
    used = 0;
    while (left > 0) {
      if (left % kItemsAPoll == 0 && problem.cancelled()) break;
      const std::uint32_t gap = gaps.lowest();
      const GapHeap::Segment s = gaps.at(gap);
      if (s.y + std::int64_t{fit.lowest()} > problem.page.height)
        break;  // nor does any item fit a higher gap
      const std::int32_t l = gaps.height_of(s.left), r = gaps.height_of(s.right);
      const WidestFit::Entry* entry = fit.find({s.width, problem.page.height - s.y});
      if (!entry) {
        gaps.raise(gap, std::min(l, r));
        continue;
      }
      const WidestFit::Entry e = *entry;
      const bool at_right = r > l;
      const std::int32_t x = at_right ? s.x + s.width - e.size.width : s.x;
      layout.placements[e.item] = {layout.pages, x, s.y, e.rotated};
      filled.back() += e.size.area();
      used = std::max(used, s.y + e.size.height);
      gaps.put(gap, e.size, at_right);
      fit.remove(e.item);
      --left;
    }
  }
  layout.unplaced = static_cast<std::uint32_t>(left);
  layout.last_used = layout.pages == 1 ? used : layout.pages ? filled.back() : 0;
  return layout;
}

}  // namespace atlas::pack
