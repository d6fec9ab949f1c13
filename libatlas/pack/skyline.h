// Internal: one page as its skyline, with a map of the waste below it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/pack/free_rects.h"

namespace atlas::pack {

// Holes below the skyline, in buckets by the power of two of their smaller side. A look-up tries a
// bounded number of holes a bucket, so it costs the same however many there are.
class WasteMap {
 public:
  void add(const Rect& hole);
  // Takes a hole that holds the item, puts what is left of it back, and returns the item's place.
  bool take(Extent item, bool allow_rotation, Rect& place, bool& rotated);
  std::size_t size() const;

 private:
  static constexpr std::size_t kTries = 24;
  std::array<std::vector<Rect>, 32> buckets_;
};

// The skyline packer (Jylänki 2010; the waste map is Wei et al.'s and Jylänki's): places an item at
// the lowest position over the skyline (bottom_left) or where it buries the least (min_waste). What
// it buries goes to the waste map, which is asked first. One search is linear in the number of
// segments, at most the page's width and typically its square root of items: a sliding window keeps
// the highest segment and the area below.
class Skyline {
 public:
  explicit Skyline(Extent page);

  // A find that hits the waste map takes the hole out at once: a spot found must be placed.
  bool find(Extent item, bool allow_rotation, PlaceRule rule, Spot& spot);
  void place(const Rect& rect);
  // A rectangle anywhere in the page; the skyline rises above it.
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
  Rect from_waste_;  // the place last found in the waste map
  std::int64_t filled_ = 0;
  std::int32_t used_height_ = 0;
};

}  // namespace atlas::pack
