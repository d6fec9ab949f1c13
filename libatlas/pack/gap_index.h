// Internal: the choice of gap_fill.h among many items, without a look at each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/pack.h"

namespace atlas::pack {

// An item in one of its directions. Rank 2 i is the i-th of a sequence as it came, 2 i + 1 the same
// turned. All searches name the smallest rank that is left.
struct RankedExtent {
  Extent size;
  std::uint32_t rank = 0;
};
inline constexpr std::uint32_t kNoRank = UINT32_MAX;

// Entries sorted by width, then by height, under a tree of their smallest ranks: O(log n).
class SizeTable {
 public:
  SizeTable(std::vector<RankedExtent> entries, std::size_t ranks);

  // Of `width`, with heights in [low, high].
  std::uint32_t of_width(std::int32_t width, std::int32_t low, std::int32_t high) const;
  std::int32_t least_width() const;  // INT32_MAX if nothing is left
  void remove(std::uint32_t rank);

 private:
  std::size_t from(std::int32_t width, std::int32_t height) const;

  std::vector<Extent> sizes_;
  std::vector<std::uint32_t> place_;  // of a rank, in sizes_
  std::size_t leaves_;
  std::vector<std::uint32_t> least_;  // the tree; leaves from leaves_ on
};

// A k-d tree over widths and heights, for the first entry that fits a room: O(sqrt n) at worst.
class FittingTree {
 public:
  FittingTree(std::vector<RankedExtent> entries, std::size_t ranks);

  std::uint32_t first(Extent room) const;
  void remove(std::uint32_t rank);

 private:
  static constexpr std::size_t kLeaf = 8;  // entries, about
  struct Node {
    Extent low, high;  // bounds of what was there at first
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
  std::vector<Range> leaf_;           // of entries_
  std::vector<std::uint32_t> place_;  // of a rank, in entries_
};

class GapIndex {
 public:
  GapIndex(std::span<const Extent> items, std::span<const std::uint32_t> sequence,
           bool allow_rotation);

  // A gap of the skyline, its room up to the page's top, and its walls' heights over its floor.
  struct Gap {
    Extent room;
    std::int32_t tall = 0, low = 0;
  };
  struct Choice {
    std::uint32_t rank = kNoRank;
    bool at_low_wall = false;
  };
  // As GapFill: the gap's width and a wall's height before its width, higher than both walls,
  // before its width before the taller wall's height before the lower's before whatever fits.
  Choice choose(const Gap& gap) const;
  void remove(std::uint32_t rank);  // in both directions
  std::int32_t lowest() const { return heights_.least_width(); }

 private:
  GapIndex(const std::vector<RankedExtent>& entries, std::size_t ranks);
  std::uint32_t as_wide_as(const Gap& gap) const;

  std::vector<std::uint8_t> has_;  // 1 a rank: whether it is an entry
  SizeTable widths_, heights_;     // the latter with sides swapped
  FittingTree fitting_;
};

}  // namespace atlas::pack
