#include <algorithm>
#include <array>
#include <bit>
#include <queue>

#include "libatlas/pack/engines.h"

namespace atlas::pack {
namespace {

// Items in both allowed directions, sorted by width; finds the widest that fits a gap.
class WidestFit {
 public:
  explicit WidestFit(const Problem& problem) {
    for (std::uint32_t i = 0; i < problem.items.size(); ++i) {
      const Extent e = problem.items[i];
      entries_.push_back({e, i, false});
      if (problem.allow_rotation && e.width != e.height)
        entries_.push_back({{e.height, e.width}, i, true});
    }
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      if (a.size.width != b.size.width) return a.size.width < b.size.width;
      if (a.size.height != b.size.height) return a.size.height < b.size.height;
      return a.item != b.item ? a.item > b.item : a.rotated > b.rotated;
    });
    leaves_ = std::bit_ceil(entries_.size() + 1);  // one spare: find() starts behind the last
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

  // The widest item (ties: tallest, smallest id) no larger than the room; null if there is none.
  const Entry* find(Extent room) const {
    const auto after =
        std::upper_bound(entries_.begin(), entries_.end(), room.width,
                         [](std::int32_t width, const Entry& e) { return width < e.size.width; });
    std::size_t node = leaves_ + static_cast<std::size_t>(after - entries_.begin());
    // Up from the end of the range until a subtree to the left holds one low enough, then down.
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
  std::vector<std::int32_t> lowest_;  // tree: smallest height among what is left
  std::vector<std::array<std::size_t, 2>> other_;
};

// The skyline as a linked list, and its segments in a heap by (y, x); stale entries are skipped.
class GapHeap {
 public:
  explicit GapHeap(Extent page) : page_(page) {
    segments_.push_back({0, 0, page.width, kEnd, kEnd, true});
    heap_.push({0, 0, 0});
  }

  // The lowest, then leftmost segment.
  std::uint32_t lowest() {
    while (true) {
      const Key key = heap_.top();
      const Segment& s = segments_[key.id];
      if (s.alive && s.y == key.y && s.x == key.x) return key.id;
      heap_.pop();
    }
  }

  struct Segment {
    std::int32_t x, y, width;
    std::uint32_t left, right;
    bool alive;
  };
  const Segment& at(std::uint32_t id) const { return segments_[id]; }
  std::int32_t height_of(std::uint32_t id) const { return id == kEnd ? page_.height : at(id).y; }

  void raise(std::uint32_t id, std::int32_t y) {
    segments_[id].y = y;
    settle(id);
  }

  // Puts a block on the segment's left end, or right end.
  void put(std::uint32_t id, Extent size, bool at_right) {
    if (size.width == segments_[id].width) return raise(id, segments_[id].y + size.height);
    const auto fresh = static_cast<std::uint32_t>(segments_.size());
    Segment top = segments_[id];
    top.y += size.height;
    top.width = size.width;
    segments_[id].width -= size.width;
    if (at_right) {
      top.x += segments_[id].width;
      top.left = id;
      if (top.right != kEnd) segments_[top.right].left = fresh;
      segments_[id].right = fresh;
    } else {
      segments_[id].x += size.width;
      top.right = id;
      if (top.left != kEnd) segments_[top.left].right = fresh;
      segments_[id].left = fresh;
    }
    segments_.push_back(top);
    heap_.push({segments_[id].y, segments_[id].x, id});
    settle(fresh);
  }

 private:
  struct Key {
    std::int32_t y, x;
    std::uint32_t id;
    bool operator<(const Key& o) const {  // for a heap whose top is the smallest
      return y != o.y ? y > o.y : x > o.x;
    }
  };
  static constexpr std::uint32_t kEnd = UINT32_MAX;

  // Joins a segment with neighbours of its height and files it.
  void settle(std::uint32_t id) {
    Segment& s = segments_[id];
    if (s.right != kEnd && segments_[s.right].y == s.y) absorb(id, s.right);
    if (s.left != kEnd && segments_[s.left].y == s.y) {
      s.x = segments_[s.left].x;
      absorb(id, s.left);
    }
    heap_.push({s.y, s.x, id});
  }
  void absorb(std::uint32_t id, std::uint32_t other) {
    Segment &s = segments_[id], &o = segments_[other];
    s.width += o.width;
    o.alive = false;
    if (s.right == other) {
      s.right = o.right;
      if (o.right != kEnd) segments_[o.right].left = id;
    } else {
      s.left = o.left;
      if (o.left != kEnd) segments_[o.left].right = id;
    }
  }

  Extent page_;
  std::vector<Segment> segments_;
  std::priority_queue<Key> heap_;
};

}  // namespace

Layout pack_widest_first(const Problem& problem) {
  Layout layout;
  layout.placements.resize(problem.items.size());
  WidestFit fit(problem);
  std::size_t left = problem.items.size();
  std::vector<std::int64_t> filled;
  std::int32_t used = 0;
  for (; left > 0 && layout.pages < problem.max_pages; ++layout.pages) {
    GapHeap gaps(problem.page);
    filled.push_back(0);
    used = 0;
    while (left > 0) {
      const std::uint32_t gap = gaps.lowest();
      const GapHeap::Segment s = gaps.at(gap);
      if (s.y + std::int64_t{fit.lowest()} > problem.page.height)
        break;  // so for all that are higher
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
