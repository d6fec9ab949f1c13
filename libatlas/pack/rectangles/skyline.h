// Internal: a page represented by its skyline, with a map of the waste below it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/pack/rectangles/free_rects.h"

namespace atlas::pack {

// The holes below the skyline, in buckets by the power of two of their smaller side. A search tries
// a limited number of holes per bucket, so its cost does not grow with the number of holes.
class WasteMap {
 public:
  void add(const Rect& hole);
  // Takes a hole that is large enough for the item out of the map, puts the rest of the hole back,
  // and returns the item's place. Returns false if no such hole was found.
  bool take(Extent item, bool allow_rotation, Rect& place, bool& rotated);
  std::size_t size() const;

 private:
  static constexpr std::size_t kTries = 24;
  std::array<std::vector<Rect>, 32> buckets_;
};

// The skyline packer (Jylänki 2010; the waste map is from Wei et al. and Jylänki). It places an
// item at the lowest position over the skyline (bottom_left) or where it buries the least area
// (min_waste). The area that it buries goes to the waste map, which is searched first. A search
// takes time linear in the number of segments, since a sliding window keeps track of the highest
// segment and of the area below. There are at most as many segments as cells in the page's width,
// and typically about the square root of the number of items.
class Skyline {
 public:
  explicit Skyline(Extent page);

  // If the place comes from the waste map, the hole is removed from it at once, so the place must
  // be used.
  bool find(Extent item, bool allow_rotation, PlaceRule rule, Spot& spot);
  void place(const Rect& rect);
  // Blocks a rectangle anywhere in the page. The skyline rises above it.
  void block(const Rect& rect);
  void drop_smaller(std::int32_t, std::int32_t) {}
  Room room() const;

  bool empty() const { return filled_ == 0; }
  std::int64_t filled() const { return filled_; }
  std::int32_t used_height() const { return used_height_; }

 private:
  struct Segment {
    std::int32_t x, y, width;
  };
  bool find_over(Extent item, PlaceRule rule, Spot& spot) const;
  void raise(const Rect& rect, bool keep_waste);

  Extent page_;
  std::vector<Segment> segments_, scratch_;
  WasteMap waste_;
  Rect from_waste_;  // the place that was last found in the waste map
  std::int64_t filled_ = 0;
  std::int32_t used_height_ = 0;
};

}  // namespace atlas::pack
