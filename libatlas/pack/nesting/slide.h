// Internal: moves charts on a page towards each other.
#pragma once

#include <algorithm>
#include <vector>

#include "libatlas/pack/nesting/plain_page.h"

namespace atlas::pack {

struct SlidingMask {
  const Mask* mask = nullptr;
  BitPage::Place at;
  std::uint32_t chart = 0;
};

inline bool is_free_at(const SlidingMask& m, BitPage::Place at, const PlainPage& page) {
  return at.x >= 0 && at.y >= 0 && at.x + m.mask->width <= page.width() &&
         page.is_free(*m.mask, at);
}

// Moves every mask as far as it can go, down (step 0, -1) or left (-1, 0), beginning with those
// nearest to the edge. `masks` must be all masks on the page. Returns whether any mask has moved.
inline bool slide(BitPage::Place step, PlainPage& page, std::vector<SlidingMask>& masks) {
  const auto along = [&](const SlidingMask& m) { return step.x != 0 ? m.at.x : m.at.y; };
  std::stable_sort(masks.begin(), masks.end(),
                   [&](const SlidingMask& a, const SlidingMask& b) { return along(a) < along(b); });
  bool any = false;
  for (SlidingMask& m : masks) {
    page.take_away(*m.mask, m.at);
    for (BitPage::Place to; to = {m.at.x + step.x, m.at.y + step.y}, is_free_at(m, to, page);) {
      m.at = to;
      any = true;
    }
    page.put(*m.mask, m.at);
  }
  return any;
}

}  // namespace atlas::pack
