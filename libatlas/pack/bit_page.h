// Internal: the free cells of a page as bit rows, with the tables that make the search for a place
// of an arbitrary mask fast.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/pack/outline_mask.h"

namespace atlas::pack {

// A row of a mask: what a page's row needs at least to take it.
struct RowTest {
  std::int32_t row = 0;
  std::int32_t length_class = 0;  // of the row's longest run: see BitPage
};

// Bit x + offset of this level says whether a part of a run of this row is free when the mask is
// at x.
struct Probe {
  std::int32_t row = 0;
  std::uint32_t level : 5, offset : 27;
};

// How a mask is looked for, in an order that finds out early about a place that does not work: the
// row with the longest run first, then rows spread over the whole height.
struct MaskTests {
  std::int32_t width = 0, height = 0;
  std::vector<RowTest> rows;
  std::vector<Probe> probes;
};
MaskTests test_order(const Mask& mask);

// Level k of a row has bit x set if the 2^k cells from x on are free. A run of length L at x is
// free if and only if level floor(log2 L) has the bits x and x + L - 2^floor(log2 L): two word-wise
// ANDs test 64 positions of x at once, whatever the length.
class BitPage {
 public:
  // longest_run: of all masks that will be asked for; height may be generous, rows cost memory
  // only when first touched.
  BitPage(std::int32_t width, std::int32_t height, std::int32_t longest_run);

  std::int32_t width() const { return width_; }
  std::int32_t height() const { return height_; }
  std::int32_t used_height() const { return used_height_; }

  struct Place {
    std::int32_t x = 0, y = 0;
    bool operator==(const Place&) const = default;
  };

  // Where to look: the box's lower left corner within these limits, inclusive.
  struct Window {
    std::int32_t x0 = 0, x1 = 1 << 30, y0 = 0, y1 = 1 << 30;
  };

  // The lowest place (then leftmost) in the window, or false.
  bool find(const MaskTests& tests, Window window, Place& place);

  // Bit k says whether the mask may lie with its foot in row y + k >= 0: for each of its rows the
  // page has a free run about as long as it needs. What this denies is sure; it looks at 64 feet at
  // once.
  std::uint64_t likely_feet(const MaskTests& tests, std::int32_t y);

  // The leftmost place with the foot in row y and x0 <= x <= x1 <= width() - mask.width, or false.
  bool find_in_row(const MaskTests& tests, Window window, std::int32_t y, Place& place);

  void put(const Mask& mask, Place place);
  void take_away(const Mask& mask, Place place);
  void clear();

  // Words looked at or written so far: the measure of effort for limits that must not depend on a
  // clock.
  std::uint64_t work() const { return work_; }

  bool is_free(std::int32_t x, std::int32_t y) const;

 private:
  const std::uint64_t* row(int level, std::int32_t y) const {
    return bits_.data() + (std::size_t(y) * levels_ + level) * stride_;
  }
  std::uint64_t* row(int level, std::int32_t y) {
    return bits_.data() + (std::size_t(y) * levels_ + level) * stride_;
  }
  // Pages of few words a row, as the search for a plan has them, keep rows in registers.
  template <std::size_t kWords>
  bool find_narrow(const MaskTests& tests, Window window, std::int32_t y, Place& place);
  template <std::size_t kWords>
  void rebuild_narrow(std::int32_t y);
  bool find_wide(const MaskTests& tests, Window window, std::int32_t y, Place& place);
  void rebuild_wide(std::int32_t y, std::int32_t begin, std::int32_t end);
  void rebuild(std::int32_t y, std::int32_t begin, std::int32_t end);

  bool narrows(const std::uint64_t* bits, std::uint32_t offset);
  void all_candidates(std::int32_t x0, std::int32_t x1);
  std::int32_t longest_free(std::int32_t y) const;
  void set_longest(std::int32_t y, std::int32_t longest);
  void grow(std::int32_t rows);

  std::int32_t width_, height_;
  int levels_;
  std::size_t words_, stride_;  // words a row; with one spare word for shifted reads
  std::int32_t rows_ = 0;       // rows that exist in bits_; all above are free
  std::int32_t used_height_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<std::int32_t> longest_;  // 1 a row: length of its longest free run
  // The same for 64 rows at once: bit y % 64 of word y / 64 * classes_ + c is set if row y has a
  // free run of length_of(c) cells.
  std::size_t classes_;
  std::vector<std::uint64_t> long_rows_;
  std::vector<std::uint64_t> empty_;  // the levels of a free row
  std::vector<std::uint64_t> candidates_;
  std::uint64_t work_ = 0;
  std::size_t low_ = 0, high_ = 0;  // words of candidates_ that may be nonzero
};

}  // namespace atlas::pack
