// Internal: a skyline whose lowest gap is found in O(log n).
#pragma once

#include <cstdint>
#include <queue>
#include <tuple>
#include <vector>

#include "libatlas/pack/pack.h"

namespace atlas::pack {

// The skyline as a linked list, with a heap of its segments by (y, x). Outdated entries of the heap
// are skipped.
class GapHeap {
 public:
  explicit GapHeap(Extent page) : page_(page) {
    segments_.push_back({0, 0, page.width, kEnd, kEnd, true});
    heap_.push({0, 0, 0});
  }

  // Returns the lowest segment, and the leftmost of several.
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

  // Puts a block on the left or the right end of the segment.
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
      return std::tie(y, x, id) > std::tie(o.y, o.x, o.id);
    }
  };
  static constexpr std::uint32_t kEnd = UINT32_MAX;

  // Joins a segment with neighbours of the same height and adds it to the heap.
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

}  // namespace atlas::pack
