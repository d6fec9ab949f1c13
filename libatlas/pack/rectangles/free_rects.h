// Internal: a page represented by the list of its maximal free rectangles.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/pack/pack.h"
#include "libatlas/pack/rectangles/room.h"

namespace atlas::pack {

enum class PlaceRule {
  bottom_left,  // the lowest top edge, then the leftmost; skylines compare the buried area before
                // the latter
  contact,      // the longest touching perimeter, then bottom_left (maximal rectangles only)
  min_waste,    // the least buried area, then bottom_left (skylines only)
};

// A place found for an item. Places are compared by (first, second, third), and smaller is better.
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

// The maximal free rectangles of a page (Jylänki 2010, "MaxRects"), sorted by (y, x). The first
// rectangle that is large enough is therefore the bottom-left place, and a rectangle can only lie
// within one that is not behind it in y.
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

  // Finds the best place by the rule. Returns false if there is none. Sides must be positive.
  bool find(Extent item, bool allow_rotation, PlaceRule rule, Spot& spot) const;

  // Removes `rect`, which may lie anywhere in the page, from the free space.
  void place(const Rect& rect);
  void block(const Rect& rect) { place(rect); }

  // Frees a rectangle that was placed. The free rectangles are then those of a page on which it
  // never was.
  void take_away(const Rect& rect);

  // Removes free rectangles that are too small for every item of at least these sides.
  void drop_smaller(std::int32_t width, std::int32_t height);

  const Room& room() const { return room_; }

 private:
  bool find_bottom_left(Extent item, Spot& spot) const;
  bool find_contact(Extent item, Spot& spot) const;
  std::int64_t contact_length(const Rect& rect) const;
  void split(const Rect& free, const Rect& taken);
  void note_neighbour(const Rect& free, const Rect& taken);
  void keep_maximal();
  std::vector<Rect> free_around(const Rect& rect) const;
  void measure_room();

  enum class Side : std::uint8_t { left, right, below, above };
  // A free rectangle that ends at a side of the placed one: how far it begins from there (smaller
  // is farther), and its ends along the side.
  struct Beside {
    Side side;
    bool fresh;  // cut from a free rectangle that the placed one meets
    std::int32_t start, low, high;
    Rect rect;
  };
  static Beside beside(Side side, const Rect& rect, bool fresh);

  Extent page_;
  std::vector<Rect> free_, fresh_, placed_;
  std::vector<Beside> beside_;
  std::vector<std::pair<std::int32_t, std::int32_t>> front_;  // see keep_maximal()
  std::int32_t min_width_ = 1, min_height_ = 1;
  std::int32_t used_height_ = 0;
  Room room_;
};

}  // namespace atlas::pack
