// Internal: beam search for a layout of limited height.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libatlas/pack/rectangles/gap_fill.h"

namespace atlas::pack {

// Builds partial layouts gap by gap along their skylines. All have the same number of items, and
// the search continues with those that waste least for the items they hold (Libralesso and Fontan
// 2021 use a similar guide). This works well if little waste is allowed, because exceeding it is
// what ends a partial layout early.
class StripBeam {
 public:
  StripBeam(std::span<const Extent> items, std::int32_t width, bool allow_rotation);

  struct Limits {
    std::int32_t height = 0;  // maximum height of the layout
    std::size_t states = 8;   // number of partial layouts that are kept
    // How much large items are preferred: an exponent of their area, a multiple of 1/2.
    double large_first = 3;
    std::function<bool()> stop;  // called after every item; true ends the search; may be empty
  };
  // Places all items. Returns an empty list if it found no layout.
  std::vector<GapPlacement> pack(const Limits& limits);

 private:
  struct Segment {
    std::int32_t x, y, width;
  };
  struct Kind {  // items of the same size
    Extent size;
    std::vector<std::uint32_t> items;
  };
  struct State {
    std::vector<Segment> skyline;
    std::vector<std::uint16_t> left;  // number of items left of each kind
    std::int64_t waste = 0, area = 0;
    std::uint64_t contents = 0;  // hash of the items that have been placed
    std::uint32_t node = 0, smallest = 0;
  };
  struct Child {
    double guide;
    std::uint32_t state, kind;
    bool rotated, at_right;
  };
  // The gap to fill: its width, the height up to the strip's top, the heights of its walls, and the
  // smallest possible width of the items left.
  struct Gap {
    std::int32_t width, room, left, right, least;
  };
  struct Node {
    std::uint32_t parent, kind;
    std::int32_t x, y;
    bool rotated;
  };

  State empty_strip() const;
  bool next_gap(State& state, std::size_t& gap) const;
  void add_children(std::uint32_t index, State& state);
  void try_child(const State& state, const Gap& gap, Extent size, Child child);
  double weight(double area) const;
  bool grow(const Child& child, State& state) const;
  bool close_narrow_gaps(State& state) const;
  void raise(State& state, std::size_t gap) const;
  static void merge(std::vector<Segment>& skyline, std::size_t at);
  static std::size_t lowest(const std::vector<Segment>& skyline);
  std::int32_t smallest_left(State& state) const;
  std::uint64_t fingerprint(const State& state) const;
  std::int32_t wall(const State& state, std::size_t gap, bool right) const;
  std::vector<GapPlacement> trace(std::uint32_t node) const;
  Extent turned(const Child& child) const;

  std::span<const Extent> items_;
  std::int32_t width_, height_ = 0;
  double large_first_ = 3;
  bool allow_rotation_;
  std::size_t count_ = 0;
  std::int64_t total_ = 0, allowed_waste_ = 0;
  double mean_ = 0;  // area of an item
  std::vector<Kind> kinds_;
  // Kinds in ascending order of their smallest possible width.
  std::vector<std::uint32_t> by_side_;
  std::vector<Child> children_;
  std::vector<Node> nodes_;
};

}  // namespace atlas::pack
