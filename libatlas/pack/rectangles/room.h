// Internal: an upper limit on the items that a page has room for. It is quick to compare and to
// join.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "libatlas/pack/pack.h"

namespace atlas::pack {

// Stores, for classes of height (two per octave), the width of the widest hole that is at least so
// high. An item can fit only if the width stored for its height's class, rounded down, is large
// enough. With classes this fine, few pages pass the test that have no room.
class Room {
 public:
  void add(Extent hole) {
    std::int32_t& w = width_[class_of(hole.height)];
    w = std::max(w, hole.width);
  }
  // To be called after the last add(). A hole that is high enough for a class is high enough for
  // all lower classes.
  void finish() {
    for (std::size_t c = kClasses - 1; c-- > 0;) width_[c] = std::max(width_[c], width_[c + 1]);
  }
  bool may_hold(Extent item) const { return item.width <= width_[class_of(item.height)]; }
  bool may_hold(Extent item, bool turned_too) const {
    return may_hold(item) || (turned_too && may_hold({item.height, item.width}));
  }
  static Room of_either(const Room& a, const Room& b) {
    Room room;
    for (std::size_t c = 0; c < kClasses; ++c) room.width_[c] = std::max(a.width_[c], b.width_[c]);
    return room;
  }
  bool operator==(const Room&) const = default;

 private:
  // The classes begin at heights 1, 2, 3, 4, 6, 8, 12, ... 3072. Greater heights belong to the last
  // class.
  static constexpr std::size_t kClasses = 24;
  static std::size_t class_of(std::int32_t height) {
    const auto h = static_cast<std::uint32_t>(std::max(1, height));
    const auto octave = static_cast<std::size_t>(std::bit_width(h)) - 1;
    const std::size_t half = octave > 0 && (h >> (octave - 1) & 1);
    return std::min(kClasses - 1, 2 * octave + half);
  }
  std::array<std::int32_t, kClasses> width_{};
};

}  // namespace atlas::pack
