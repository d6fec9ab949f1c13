// Internal: makes the choice of gap_fill.h among many items without examining each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/pack.h"

namespace atlas::pack {

// An item in one of its directions. Rank 2 i is the i-th item of a sequence as given, rank 2 i + 1
// the same item turned. All searches return the smallest rank that has not been removed.
struct RankedExtent {
  Extent size;
  std::uint32_t rank = 0;
};
inline constexpr std::uint32_t kNoRank = UINT32_MAX;

// Entries sorted by width, then by height, with a tree over their smallest ranks. Searches take
// O(log n).
class SizeTable {
 public:
  SizeTable(std::vector<RankedExtent> entries, std::size_t ranks);

  // Returns the smallest rank of this width with a height in [low, high].
  std::uint32_t of_width(std::int32_t width, std::int32_t low, std::int32_t high) const;
  std::int32_t least_width() const;  // INT32_MAX if no entry is left
  void remove(std::uint32_t rank);

 private:
  std::size_t from(std::int32_t width, std::int32_t height) const;

  std::vector<Extent> sizes_;
  std::vector<std::uint32_t> place_;  // index in sizes_, by rank
  std::size_t leaves_;
  std::vector<std::uint32_t> least_;  // the tree; its leaves begin at leaves_
};

// A k-d tree over widths and heights, which finds the first entry that fits a room in O(sqrt n) at
// worst.
class FittingTree {
 public:
  FittingTree(std::vector<RankedExtent> entries, std::size_t ranks);

  std::uint32_t first(Extent room) const;
  void remove(std::uint32_t rank);

 private:
  static constexpr std::size_t kLeaf = 8;  // entries per leaf, approximately
  struct Node {
    Extent low, high;  // bounds of the entries that were there at first
    std::uint32_t least = kNoRank;
  };
  struct Range {
    std::size_t begin = 0, end = 0;
  };
  void build(std::size_t node, Range range, bool by_width);
  void descend(std::size_t node, Extent room, std::uint32_t& best) const;

  std::vector<RankedExtent> entries_;
  std::size_t leaves_;
  std::vector<Node> nodes_;
  std::vector<Range> leaf_;           // ranges of entries_
  std::vector<std::uint32_t> place_;  // index in entries_, by rank
};

class GapIndex {
 public:
  GapIndex(std::span<const Extent> items, std::span<const std::uint32_t> sequence,
           bool allow_rotation);

  // A gap of the skyline: its room up to the page's top, and the heights of its walls above its
  // floor.
  struct Gap {
    Extent room;
    std::int32_t tall = 0, low = 0;
  };
  struct Choice {
    std::uint32_t rank = kNoRank;
    bool at_low_wall = false;
  };
  // Chooses as GapFill does, in this order of preference: the width of the gap and the height of a
  // wall; the width of the gap and higher than both walls; the width of the gap; the height of the
  // taller wall; the height of the lower wall; any item that fits.
  Choice choose(const Gap& gap) const;
  void remove(std::uint32_t rank);  // removes both directions
  std::int32_t lowest() const { return heights_.least_width(); }

 private:
  GapIndex(const std::vector<RankedExtent>& entries, std::size_t ranks);
  std::uint32_t as_wide_as(const Gap& gap) const;

  std::vector<std::uint8_t> has_;  // one per rank: whether it is an entry
  SizeTable widths_, heights_;     // heights_ has its sides swapped
  FittingTree fitting_;
};

}  // namespace atlas::pack
