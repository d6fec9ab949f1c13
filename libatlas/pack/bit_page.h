// Internal: the free cells of a page as bit rows, with the tables that make the search for a place
// of an arbitrary mask fast.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "libatlas/pack/outline_mask.h"

namespace atlas::pack {

// The order in which a mask's rows are tested, chosen so that a place that does not work is found
// out early: the row with the longest run first, then rows spread over the whole height.
struct RowTest {
  std::int32_t row = 0;
  std::int32_t longest = 0;       // cells of the row's longest run
  std::int32_t length_class = 0;  // class of that length: see BitPage
};
std::vector<RowTest> test_order(const Mask& mask);

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
  };

  // Where to look: the box's lower left corner within these limits, inclusive.
  struct Window {
    std::int32_t x0 = 0, x1 = 1 << 30, y0 = 0, y1 = 1 << 30;
  };

  // The lowest place (then leftmost) in the window, or false.
  bool find(const Mask& mask, const std::vector<RowTest>& rows, Window window, Place& place);

  // Bit k says whether the mask may lie with its foot in row y + k >= 0: for each of its rows the
  // page has a free run about as long as it needs. What this denies is sure; it looks at 64 feet at
  // once.
  std::uint64_t likely_feet(const std::vector<RowTest>& rows, std::int32_t y);

  // The leftmost place with the foot in row y and x0 <= x <= x1 <= width() - mask.width, or false.
  bool find_in_row(const Mask& mask, const std::vector<RowTest>& rows, Window window,
                   std::int32_t y, Place& place);

  // Share of the mask's outline, put there, that touches taken cells or the page's left, right or
  // lower edge; in [0, 1].
  double contact(const Mask& mask, Place place) const;

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
  bool row_allows(const Mask& mask, std::int32_t r, std::int32_t y);
  std::int32_t taken(std::int32_t y, std::int32_t begin, std::int32_t end) const;
  void all_candidates(std::int32_t x0, std::int32_t x1);
  std::int32_t longest_free(std::int32_t y) const;
  void set_longest(std::int32_t y, std::int32_t longest);
  void rebuild(std::int32_t y, std::int32_t begin, std::int32_t end);
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
