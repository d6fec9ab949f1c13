// Internal: the free cells of a page as rows of bits, with tables that speed up the search for a
// place of an arbitrary mask.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/pack/outlines/outline_mask.h"

namespace atlas::pack {

// The minimum that one row of a mask requires of a page's row.
struct RowTest {
  std::int32_t row = 0;
  std::int32_t length_class = 0;  // class of the length of the row's longest run; see BitPage
};

// If the mask is at x, bit x + offset of this level in the page's row says whether a part of a run
// of the mask's row is free.
struct Probe {
  std::int32_t row = 0;
  std::uint32_t level : 5, offset : 27;
};

// The tests of a place for a mask, in an order that rejects an unsuitable place early: first the
// row with the longest run, then rows spread over the whole height.
struct MaskTests {
  std::int32_t width = 0, height = 0;
  std::vector<RowTest> rows;
  std::vector<Probe> probes;
};
MaskTests test_order(const Mask& mask);

// The probes of a mask that ruled rows out last, the latest first, by their index in
// MaskTests::probes. What rules a row out is likely to rule out the next row as well, so these
// probes are made first: of six to eight probes a row, four are left.
class RecentProbes {
 public:
  static constexpr std::size_t kMost = 4;

  std::size_t size() const { return size_; }
  std::uint32_t operator[](std::size_t k) const { return probes_[k]; }

  // Records that the recent probe at place k ruled a row out again.
  void again(std::size_t k) { std::swap(probes_[0], probes_[k]); }
  void add(std::size_t probe) {
    if (size_ < kMost) ++size_;
    probes_[size_ - 1] = static_cast<std::uint32_t>(probe);
    again(size_ - 1);
  }

 private:
  std::array<std::uint32_t, kMost> probes_;
  std::uint32_t size_ = 0;
};

// Returns the length of the longest run of ones.
std::int32_t longest_run(std::span<const std::uint64_t> bits);

// In level k of a row, bit x is set if the 2^k cells from x on are free. A run of length L at x is
// free if and only if level floor(log2 L) has the bits x and x + L - 2^floor(log2 L). So two
// word-wise ANDs test 64 positions of x at once, whatever the length is.
class BitPage {
 public:
  // longest_run: the length of the longest run of all masks that will be placed. The height may be
  // generous, because rows take memory only when they are first used.
  BitPage(std::int32_t width, std::int32_t height, std::int32_t longest_run);

  std::int32_t width() const { return width_; }
  std::int32_t height() const { return height_; }
  std::int32_t used_height() const { return used_height_; }

  struct Place {
    std::int32_t x = 0, y = 0;
    bool operator==(const Place&) const = default;
  };

  // Limits of a search: the box's lower left corner must lie within them, bounds included.
  struct Window {
    std::int32_t x0 = 0, x1 = 1 << 30, y0 = 0, y1 = 1 << 30;
  };

  // Finds the lowest, then leftmost place in the window. Returns false if there is none.
  bool find(const MaskTests& tests, Window window, Place& place);

  // Bit k says whether the mask may lie with its foot in row y + k, where y >= 0: whether the
  // page's rows have free runs that are about as long as the mask's rows need. Up to 24 rows of the
  // mask are tested. A bit that is 0 rules the row out for certain. The function tests 64 feet at
  // once.
  std::uint64_t likely_feet(const MaskTests& tests, std::int32_t y);

  // Finds the leftmost place with the foot in row window.y0 and window.x0 <= x <= window.x1, where
  // window.x1 must be at most width() - mask.width. Returns false if there is none. `recent` should
  // come from the search in the row before, and must belong to the same mask.
  bool find_in_row(const MaskTests& tests, const Window& window, RecentProbes& recent,
                   Place& place);

  void put(const Mask& mask, Place place);
  void take_away(const Mask& mask, Place place);
  void clear();

  // The number of words read or written so far. It measures effort for limits that must not depend
  // on a clock.
  std::uint64_t work() const { return work_; }

  bool is_free(std::int32_t x, std::int32_t y) const;

 private:
  const std::uint64_t* row(int level, std::int32_t y) const {
    return bits_.data() + (std::size_t(y) * levels_ + level) * stride_;
  }
  std::uint64_t* row(int level, std::int32_t y) {
    return bits_.data() + (std::size_t(y) * levels_ + level) * stride_;
  }
  // Short rows, which most pages have, are kept in registers; see short_rows.cpp.
  struct ShortRows;
  bool has_short_rows() const { return words_ <= 8; }
  bool find_in_short_row(const MaskTests& tests, const Window& window, RecentProbes& recent,
                         Place& place);
  void rebuild_short_row(std::int32_t y);
  bool find_in_long_row(const MaskTests& tests, const Window& window, Place& place);
  void rebuild_long_row(std::int32_t y, std::int32_t begin, std::int32_t end);
  void set_cells(const Mask& mask, Place place, bool free);
  void rebuild(std::int32_t y, std::int32_t begin, std::int32_t end);

  bool narrows(const std::uint64_t* bits, std::uint32_t offset);
  void all_candidates(std::int32_t x0, std::int32_t x1);
  void set_longest(std::int32_t y, std::int32_t longest);
  void grow(std::int32_t rows);

  std::int32_t width_, height_;
  int levels_;
  // Words per row. With long rows, stride_ has a spare word for shifted reads.
  std::size_t words_, stride_;
  std::int32_t rows_ = 0;  // number of rows that exist in bits_; all rows above are free
  std::int32_t used_height_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<std::int32_t> longest_;  // one per row: the length of its longest free run
  // The same for 64 rows at once: bit y % 64 of word y / 64 * classes_ + c is set if row y has a
  // free run whose length is at least that of class c.
  std::size_t classes_;
  std::vector<std::uint64_t> long_rows_;
  std::vector<std::uint64_t> empty_;  // the levels of a free row
  std::vector<std::uint64_t> candidates_;
  std::uint64_t work_ = 0;
  std::size_t low_ = 0, high_ = 0;  // the words of candidates_ that may not be zero
};

}  // namespace atlas::pack
