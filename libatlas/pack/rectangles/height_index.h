// Internal: finds the first open page with room for items that come in descending order of height.
#pragma once

#include <algorithm>
#include <cstdint>
#include <queue>
#include <vector>

#include "libatlas/pack/rectangles/free_rects.h"

namespace atlas::pack {

// A tournament tree over the pages. It stores the width of each page's widest hole that is at least
// as high as the present item, so it is exact: a page that passes has room. A page's width changes
// when the page is used. It also changes when the present height falls to that of a hole that is
// wider, but was too low before; such pages wait in a heap.
class HeightIndex {
 public:
  void push_back(const FreeRects& page) {
    if (count_ == leaves_) grow();
    pages_.resize(++count_);
    update(count_ - 1, page);
  }

  void update(std::size_t page, const FreeRects& now) {
    std::int32_t width = 0, lower = 0;
    for (const Rect& hole : now.free())
      if (hole.height >= height_) width = std::max(width, hole.width);
    for (const Rect& hole : now.free())
      if (hole.height < height_ && hole.width > width) lower = std::max(lower, hole.height);
    pages_[page] = lower;
    if (lower > 0) waiting_.push({lower, page});
    std::size_t node = page + leaves_;
    widest_[node] = width;
    for (node /= 2; node >= 1; node /= 2)
      widest_[node] = std::max(widest_[2 * node], widest_[2 * node + 1]);
  }

  // Items are at most this high from now on.
  void sink(std::int32_t height, const std::vector<FreeRects>& pages) {
    height_ = height;
    while (!waiting_.empty() && waiting_.top().first >= height) {
      const auto [level, page] = waiting_.top();
      waiting_.pop();
      // Otherwise the page has been used since.
      if (pages_[page] == level) update(page, pages[page]);
    }
  }

  // Returns the first page with room for an item of this width and the present height; count() if
  // there is none.
  std::size_t first(std::int32_t width) const {
    if (count_ == 0 || widest_[1] < width) return count_;
    std::size_t node = 1;
    while (node < leaves_) node = 2 * node + (widest_[2 * node] < width);
    return node - leaves_;
  }

  std::size_t count() const { return count_; }

 private:
  void grow() {
    const std::size_t old = leaves_;
    leaves_ = std::max<std::size_t>(1, 2 * leaves_);
    std::vector<std::int32_t> next(2 * leaves_);
    for (std::size_t i = 0; i < count_; ++i) next[leaves_ + i] = widest_[old + i];
    widest_ = std::move(next);
    for (std::size_t node = leaves_ - 1; node >= 1; --node)
      widest_[node] = std::max(widest_[2 * node], widest_[2 * node + 1]);
  }

  std::int32_t height_ = INT32_MAX;
  std::size_t leaves_ = 0, count_ = 0;
  std::vector<std::int32_t> widest_;  // the nodes of the tree
  std::vector<std::int32_t> pages_;   // by page: the height at which its width changes; 0: never
  std::priority_queue<std::pair<std::int32_t, std::size_t>> waiting_;
};

}  // namespace atlas::pack
