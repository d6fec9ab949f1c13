// Internal: fills one page gap by gap along its skyline. For each gap it chooses the item that fits
// best (Burke et al. 2004). The scores are those of Leung et al. 2011, extended by the page's top.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/pack.h"

namespace atlas::pack {

struct GapPlacement {
  std::uint32_t item = 0;
  std::int32_t x = 0, y = 0;
  bool rotated = false;
};

// Keeps its memory between calls, since a local search calls it thousands of times per second.
class GapFill {
 public:
  GapFill(std::span<const Extent> items, Extent page, bool allow_rotation)
      : items_(items), page_(page), allow_rotation_(allow_rotation) {}

  // Fills an empty page from `sequence` (item ids; earlier ones win ties). The placed items are
  // appended to placed() and removed from the sequence, whose order is kept. Returns the used
  // height.
  std::int32_t fill(std::vector<std::uint32_t>& sequence);

  const std::vector<GapPlacement>& placed() const { return placed_; }
  std::int64_t placed_area() const { return placed_area_; }
  void clear() { placed_.clear(); }

 private:
  struct Segment {
    std::int32_t x, y, width;
  };
  struct Choice {
    int score = -1;
    std::size_t index = 0;
    bool rotated = false, at_right = false;
  };
  std::size_t lowest_segment() const;
  Choice choose(std::size_t gap) const;
  template <class Test>
  std::size_t next_block(std::size_t i, Test any) const;
  void raise(std::size_t gap);
  void put(std::size_t gap, Extent size, bool at_right);
  void merge(std::size_t segment);

  std::span<const Extent> items_;
  Extent page_;
  bool allow_rotation_;
  std::vector<std::int32_t> widths_, heights_;  // of the items of the sequence, in its order
  std::vector<Segment> skyline_;
  std::vector<GapPlacement> placed_;
  std::int64_t placed_area_ = 0;
};

}  // namespace atlas::pack
