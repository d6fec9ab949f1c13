// Internal: one page as the list of its maximal free rectangles.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/pack/pack.h"
#include "libatlas/pack/room.h"

namespace atlas::pack {

enum class PlaceRule {
  bottom_left,  // lowest top edge, then leftmost
  contact,      // longest touching perimeter, then bottom-left (maximal rectangles only)
  min_waste,    // least area buried, then bottom-left (skyline only)
};

// A place found for an item; smaller (first, second, third) is better.
struct Spot {
  Rect rect;
  bool rotated = false;
  std::int64_t first = 0, second = 0, third = 0;

  bool better_than(const Spot& other) const {
    if (first != other.first) return first < other.first;
    if (second != other.second) return second < other.second;
    return third < other.third;
  }
};

// The maximal free rectangles of a page (Jylänki 2010, "MaxRects"), kept sorted by (y, x): the
// first that is large enough is the bottom-left place, and a placed rectangle meets only those
// below its top edge.
class FreeRects {
 public:
  explicit FreeRects(Extent page);

  Extent page() const { return page_; }
  const std::vector<Rect>& free() const { return free_; }
  const std::vector<Rect>& placed() const { return placed_; }
  bool empty() const { return placed_.empty(); }
  std::int64_t filled() const {
    std::int64_t area = 0;
    for (const Rect& r : placed_) area += r.area();
    return area;
  }
  std::int32_t used_height() const { return used_height_; }

  // Finds the best place by the rule; false if there is none. Sides must be positive.
  bool find(Extent item, bool allow_rotation, PlaceRule rule, Spot& spot) const;

  // Takes `rect`, wherever it lies in the page, out of the free space.
  void place(const Rect& rect);
  void block(const Rect& rect) { place(rect); }

  // Forgets free rectangles that no item of at least these sides fits into.
  void drop_smaller(std::int32_t width, std::int32_t height);

  const Room& room() const { return room_; }

 private:
  bool find_bottom_left(Extent item, Spot& spot) const;
  bool find_contact(Extent item, Spot& spot) const;
  std::int64_t contact_length(const Rect& rect) const;
  void split(const Rect& free, const Rect& taken);
  void keep_maximal();
  void measure_room();

  Extent page_;
  std::vector<Rect> free_, fresh_, placed_;
  std::int32_t min_width_ = 1, min_height_ = 1;
  std::int32_t used_height_ = 0;
  Room room_;
};

}  // namespace atlas::pack
