#include "libatlas/pack/nesting/bit_page.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace atlas::pack {
namespace {

int level_of(std::int32_t length) {
  return std::bit_width(static_cast<std::uint32_t>(length)) - 1;
}

std::int32_t longest_in(const Mask& mask, std::int32_t r) {
  std::int32_t longest = 0;
  for (const Run& run : mask.row(r)) longest = std::max(longest, run.end - run.begin);
  return longest;
}

// The class of a length. There is one class for each length from 1 to 15 cells; longer ones are
// rounded down to eighths of an octave.
int class_of(std::int32_t length) {
  const int octave = std::max(0, level_of(length) - 3);
  return 8 * octave + (length >> octave) - 1;
}

// Adds the two bits that must be set if a run of length L at x is free; see BitPage.
void add_probes(const Mask& mask, std::int32_t r, std::vector<Probe>& probes) {
  for (const Run& run : mask.row(r)) {
    const int level = level_of(run.end - run.begin);
    const std::int32_t offsets[2] = {run.begin, run.end - (1 << level)};
    for (int side = 0; side < 1 + (offsets[1] != offsets[0]); ++side)
      probes.push_back(
          {r, static_cast<std::uint32_t>(level), static_cast<std::uint32_t>(offsets[side])});
  }
}

// Words per row: as many as a page of this width needs, or four or eight for short rows. Words
// beyond the width are never free.
std::size_t words_of(std::int32_t width) {
  const std::size_t words = (static_cast<std::size_t>(width) + 63) / 64;
  return words <= 4 ? 4 : words <= 8 ? 8 : words;
}

}  // namespace

// Returns the length of the longest run of ones.
std::int32_t longest_run(std::span<const std::uint64_t> bits) {
  std::int32_t longest = 0, current = 0;
  for (std::uint64_t word : bits) {
    if (word == ~std::uint64_t{0}) {
      current += 64;
      continue;
    }
    int left = 64;
    while (word != 0) {
      const int zeros = std::countr_zero(word);
      if (zeros > 0) {
        longest = std::max(longest, current);
        current = 0;
      }
      word >>= zeros;
      const int ones = std::countr_one(word);  // below 64, because the word is not all ones
      current += ones;
      word >>= ones;
      left -= zeros + ones;
    }
    if (left > 0) {
      longest = std::max(longest, current);
      current = 0;
    }
  }
  return std::max(longest, current);
}

MaskTests test_order(const Mask& mask) {
  MaskTests tests;
  tests.width = mask.width;
  tests.height = mask.height;
  if (mask.height == 0) return tests;
  std::vector<std::int32_t> longest(static_cast<std::size_t>(mask.height));
  for (std::int32_t r = 0; r < mask.height; ++r)
    longest[static_cast<std::size_t>(r)] = longest_in(mask, r);
  const auto first =
      static_cast<std::int32_t>(std::max_element(longest.begin(), longest.end()) - longest.begin());
  tests.rows.reserve(longest.size());
  tests.probes.reserve(2 * mask.runs.size());
  const auto add = [&](std::int32_t r) {
    tests.rows.push_back({r, class_of(longest[static_cast<std::size_t>(r)])});
    add_probes(mask, r, tests.probes);
  };
  add(first);
  // Bit-reversed counting visits halves, quarters, eighths, ...
  const int bits = std::bit_width(static_cast<std::uint32_t>(mask.height));
  std::int32_t row = 0;
  for (std::uint32_t k = 0; k < 1u << bits; ++k) {
    if (row < mask.height && row != first) add(row);
    for (int b = bits - 1; b >= 0 && ((row ^= 1 << b) >> b & 1) == 0; --b) {
    }
  }
  return tests;
}

BitPage::BitPage(std::int32_t width, std::int32_t height, std::int32_t longest_run)
    : width_(width),
      height_(height),
      levels_(level_of(std::max(1, std::min(width, longest_run))) + 1),
      words_(words_of(width)),
      stride_(has_short_rows() ? words_ : words_ + 1),
      classes_(static_cast<std::size_t>(class_of(std::max(1, width))) + 1),
      candidates_(words_) {
  empty_.assign(stride_ * static_cast<std::size_t>(levels_), 0);
  for (int k = 0; k < levels_; ++k)
    for (std::int32_t x = 0; x + (1 << k) <= width_; ++x)
      empty_[static_cast<std::size_t>(k) * stride_ + static_cast<std::size_t>(x / 64)] |=
          std::uint64_t{1} << (x % 64);
}

void BitPage::clear() {
  rows_ = 0;
  used_height_ = 0;
  longest_.clear();
  long_rows_.clear();
}

void BitPage::grow(std::int32_t rows) {
  if (rows <= rows_) return;
  // Rows of cleared pages are used again. Shifted reads may go beyond the last row.
  const std::size_t needed = static_cast<std::size_t>(rows) * empty_.size() + 2 * stride_;
  // Memory that is reserved but never written is not resident. Without this, old and new rows of a
  // large page would take memory together whenever the page grows.
  constexpr std::size_t kLarge = 1 << 17;  // words
  const auto side = static_cast<std::size_t>(std::min(height_, width_ + width_ / 4));
  const std::size_t square = side * empty_.size() + 2 * stride_;
  if (bits_.capacity() == 0 && square >= kLarge) bits_.reserve(square);
  if (bits_.size() < needed) bits_.resize(needed);
  for (; rows_ < rows; ++rows_) std::copy(empty_.begin(), empty_.end(), row(0, rows_));
  longest_.resize(static_cast<std::size_t>(rows), width_);
  long_rows_.resize((static_cast<std::size_t>(rows) + 63) / 64 * classes_, ~std::uint64_t{0});
}

void BitPage::set_longest(std::int32_t y, std::int32_t longest) {
  const int before = longest_[y] > 0 ? class_of(longest_[y]) : -1;
  const int now = longest > 0 ? class_of(longest) : -1;
  longest_[y] = longest;
  std::uint64_t* words = long_rows_.data() + static_cast<std::size_t>(y / 64) * classes_;
  const std::uint64_t bit = std::uint64_t{1} << (y % 64);
  for (int c = now + 1; c <= before; ++c) words[c] &= ~bit;
  for (int c = before + 1; c <= now; ++c) words[c] |= bit;
}

// Keeps only the candidates x where the level has bit x + offset set. Returns false if none is
// left.
bool BitPage::narrows(const std::uint64_t* bits, std::uint32_t offset) {
  const std::uint64_t* from = bits + offset / 64;
  const unsigned shift = offset % 64;
  std::uint64_t* to = candidates_.data();
  std::uint64_t any = 0;
  work_ += high_ - low_;
  if (shift == 0) {
    for (std::size_t w = low_; w < high_; ++w) any |= to[w] &= from[w];
  } else {
    for (std::size_t w = low_; w < high_; ++w)
      any |= to[w] &= (from[w] >> shift) | (from[w + 1] << (64 - shift));
  }
  return any != 0;
}

std::uint64_t BitPage::likely_feet(const MaskTests& tests, std::int32_t y) {
  std::uint64_t feet = ~std::uint64_t{0};
  const std::size_t count = long_rows_.size() / classes_;
  // If this many rows, spread over the mask, rule nothing out, testing the cells is faster.
  constexpr std::size_t kMostLooks = 24;
  std::size_t looked_at = 0;
  for (const RowTest& test : tests.rows) {
    const auto word = static_cast<std::size_t>(y + test.row) / 64;
    const unsigned shift = static_cast<unsigned>(y + test.row) % 64;
    if (word >= count) continue;  // rows above those that exist are free
    const std::uint64_t* bits = long_rows_.data() + word * classes_ + test.length_class;
    std::uint64_t free = bits[0] >> shift;
    if (shift > 0) free |= (word + 1 < count ? bits[classes_] : ~std::uint64_t{0}) << (64 - shift);
    feet &= free;
    if (++looked_at == kMostLooks || feet == 0) break;
  }
  work_ += looked_at;
  return feet;
}

// Sets the candidates to all x in [x0, x1].
void BitPage::all_candidates(std::int32_t x0, std::int32_t x1) {
  low_ = static_cast<std::size_t>(x0) / 64;
  high_ = static_cast<std::size_t>(x1) / 64 + 1;
  std::fill(candidates_.begin() + static_cast<std::ptrdiff_t>(low_),
            candidates_.begin() + static_cast<std::ptrdiff_t>(high_), ~std::uint64_t{0});
  candidates_[low_] &= ~std::uint64_t{0} << (x0 % 64);
  if (x1 % 64 != 63) candidates_[high_ - 1] &= (std::uint64_t{2} << (x1 % 64)) - 1;
}

bool BitPage::find_in_row(const MaskTests& tests, const Window& window, RecentProbes& recent,
                          Place& place) {
  return has_short_rows() ? find_in_short_row(tests, window, recent, place)
                          : find_in_long_row(tests, window, place);
}

bool BitPage::find_in_long_row(const MaskTests& tests, const Window& window, Place& place) {
  const std::int32_t y = window.y0;
  all_candidates(window.x0, window.x1);
  std::int32_t row_before = -1;
  for (const Probe& p : tests.probes) {
    if (y + p.row >= rows_) continue;
    if (p.row != row_before) {
      while (candidates_[low_] == 0) ++low_;
      while (candidates_[high_ - 1] == 0) --high_;
      row_before = p.row;
    }
    if (!narrows(row(static_cast<int>(p.level), y + p.row), p.offset)) return false;
  }
  while (candidates_[low_] == 0) ++low_;
  place = {static_cast<std::int32_t>(64 * low_) + std::countr_zero(candidates_[low_]), y};
  return true;
}

bool BitPage::find(const MaskTests& tests, Window window, Place& place) {
  window.x0 = std::max(0, window.x0);
  window.x1 = std::min(window.x1, width_ - tests.width);
  window.y1 = std::min(window.y1, height_ - tests.height);
  if (window.x0 > window.x1) return false;
  RecentProbes recent;
  for (std::int32_t y = std::max(0, window.y0); y <= window.y1; y += 64)
    for (std::uint64_t feet = likely_feet(tests, y); feet != 0; feet &= feet - 1) {
      const std::int32_t foot = y + std::countr_zero(feet);
      if (foot > window.y1) return false;
      if (find_in_row(tests, {window.x0, window.x1, foot}, recent, place)) return true;
    }
  return false;
}

// Derives the levels of a row from level 0, in which cells [begin, end) have changed.
void BitPage::rebuild(std::int32_t y, std::int32_t begin, std::int32_t end) {
  const std::size_t last = static_cast<std::size_t>(end - 1) / 64 + 1;
  work_ += static_cast<std::uint64_t>(levels_) * (last - static_cast<std::size_t>(begin) / 64);
  has_short_rows() ? rebuild_short_row(y) : rebuild_long_row(y, begin, end);
}

void BitPage::rebuild_long_row(std::int32_t y, std::int32_t begin, std::int32_t end) {
  const std::size_t last = std::min(words_, static_cast<std::size_t>(end - 1) / 64 + 1);
  for (int k = 1; k < levels_; ++k) {
    const std::uint64_t* below = row(k - 1, y);
    std::uint64_t* bits = row(k, y);
    const std::int32_t step = 1 << (k - 1);
    const std::size_t skip = static_cast<std::size_t>(step) / 64;
    const unsigned shift = static_cast<unsigned>(step) % 64;
    const auto start = static_cast<std::size_t>(std::max(0, begin - (1 << k))) / 64;
    for (std::size_t w = start; w < last; ++w) {
      std::uint64_t ahead = 0;
      if (w + skip < words_) {
        ahead = below[w + skip] >> shift;
        if (shift) ahead |= below[w + skip + 1] << (64 - shift);
      }
      bits[w] = below[w] & ahead;
    }
  }
  set_longest(y, longest_run({row(0, y), words_}));
}

void BitPage::set_cells(const Mask& mask, Place place, bool free) {
  for (std::int32_t r = 0; r < mask.height; ++r) {
    std::uint64_t* bits = row(0, place.y + r);
    for (const Run& run : mask.row(r))
      for (std::int32_t x = place.x + run.begin; x < place.x + run.end;) {
        const std::int32_t n = std::min(64 - x % 64, place.x + run.end - x);
        const std::uint64_t cells = (n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1)
                                    << (x % 64);
        bits[x / 64] = free ? bits[x / 64] | cells : bits[x / 64] & ~cells;
        x += n;
      }
  }
  // The levels are derived in a loop of their own, because a row cannot be read as vectors at once
  // after its words were written one by one: the processor would wait for them.
  for (std::int32_t r = 0; r < mask.height; ++r)
    rebuild(place.y + r, place.x, place.x + mask.width);
}

void BitPage::put(const Mask& mask, Place place) {
  grow(place.y + mask.height);
  used_height_ = std::max(used_height_, place.y + mask.height);
  set_cells(mask, place, false);
}

void BitPage::take_away(const Mask& mask, Place place) {
  set_cells(mask, place, true);
}

bool BitPage::is_free(std::int32_t x, std::int32_t y) const {
  return y >= rows_ || (row(0, y)[x / 64] >> (x % 64) & 1);
}

}  // namespace atlas::pack
