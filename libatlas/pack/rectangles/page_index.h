// Internal: finds the first open page that may have room for an item, in logarithmic time.
#pragma once

#include <algorithm>
#include <vector>

#include "libatlas/pack/rectangles/room.h"

namespace atlas::pack {

// A tournament tree over the Rooms of the pages. A page that passes may still turn out to have no
// room (see Room); the caller then asks for the next page.
class PageIndex {
 public:
  void push_back(const Room& room) {
    if (count_ == leaves_) grow();
    update(count_++, room);
  }

  void update(std::size_t page, const Room& room) {
    std::size_t node = page + leaves_;
    tree_[node] = room;
    for (node /= 2; node >= 1; node /= 2) {
      const Room both = Room::of_either(tree_[2 * node], tree_[2 * node + 1]);
      if (both == tree_[node]) return;
      tree_[node] = both;
    }
  }

  // Returns the first page >= from that passes for the item; count() if there is none.
  std::size_t next(std::size_t from, Extent item, bool allow_rotation) const {
    if (from >= count_) return count_;
    const std::size_t found = descend(1, 0, leaves_, {from, item, allow_rotation});
    return std::min(found, count_);
  }

  std::size_t count() const { return count_; }

 private:
  struct Query {
    std::size_t from;
    Extent item;
    bool allow_rotation;
  };

  std::size_t descend(std::size_t node, std::size_t begin, std::size_t end, const Query& q) const {
    if (end <= q.from || !tree_[node].may_hold(q.item, q.allow_rotation)) return count_;
    if (end - begin == 1) return begin;
    const std::size_t middle = begin + (end - begin) / 2;
    const std::size_t left = descend(2 * node, begin, middle, q);
    return left < count_ ? left : descend(2 * node + 1, middle, end, q);
  }

  void grow() {
    const std::size_t old = leaves_;
    leaves_ = std::max<std::size_t>(1, 2 * leaves_);
    std::vector<Room> next(2 * leaves_);
    for (std::size_t i = 0; i < count_; ++i) next[leaves_ + i] = tree_[old + i];
    tree_ = std::move(next);
    for (std::size_t node = leaves_ - 1; node >= 1; --node)
      tree_[node] = Room::of_either(tree_[2 * node], tree_[2 * node + 1]);
  }

  std::size_t leaves_ = 0, count_ = 0;
  std::vector<Room> tree_;
};

}  // namespace atlas::pack
