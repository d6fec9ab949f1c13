#include "libatlas/pack/bit_page.h"

#include <algorithm>

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

// Classes of lengths: 1 to 15 cells, then eighths of an octave, rounded down.
int class_of(std::int32_t length) {
  const int octave = std::max(0, level_of(length) - 3);
  return 8 * octave + (length >> octave) - 1;
}

RowTest row_test(const Mask& mask, std::int32_t r) {
  const std::int32_t longest = longest_in(mask, r);
  return {r, longest, class_of(longest)};
}

}  // namespace

std::vector<RowTest> test_order(const Mask& mask) {
  if (mask.height == 0) return {};
  std::vector<RowTest> tests{row_test(mask, 0)};
  for (std::int32_t r = 1; r < mask.height; ++r)
    if (longest_in(mask, r) > tests[0].longest) tests[0] = row_test(mask, r);
  // Bit-reversed counting visits halves, quarters, eighths, ...
  const int bits = std::bit_width(static_cast<std::uint32_t>(mask.height));
  std::int32_t row = 0;
  for (std::uint32_t k = 0; k < 1u << bits; ++k) {
    if (row < mask.height && row != tests[0].row) tests.push_back(row_test(mask, row));
    for (int b = bits - 1; b >= 0 && ((row ^= 1 << b) >> b & 1) == 0; --b) {
    }
  }
  return tests;
}

BitPage::BitPage(std::int32_t width, std::int32_t height, std::int32_t longest_run)
    : width_(width),
      height_(height),
      levels_(level_of(std::max(1, std::min(width, longest_run))) + 1),
      words_((static_cast<std::size_t>(width) + 63) / 64),
      stride_(words_ + 1),
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
  bits_.clear();
  longest_.clear();
  long_rows_.clear();
}

void BitPage::grow(std::int32_t rows) {
  if (rows <= rows_) return;
  for (; rows_ < rows; ++rows_) bits_.insert(bits_.end(), empty_.begin(), empty_.end());
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

// Narrows the candidates to those x where row r of the mask, put at page row y, is free. False if
// none is left.
bool BitPage::row_allows(const Mask& mask, std::int32_t r, std::int32_t y) {
  for (const Run& run : mask.row(r)) {
    const int level = level_of(run.end - run.begin);
    const std::uint64_t* bits = row(level, y);
    const std::int32_t offsets[2] = {run.begin, run.end - (1 << level)};
    for (int side = 0; side < 1 + (offsets[1] != offsets[0]); ++side) {
      const std::size_t skip = static_cast<std::size_t>(offsets[side]) / 64;
      const unsigned shift = static_cast<unsigned>(offsets[side]) % 64;
      const std::uint64_t* from = bits + skip;
      std::uint64_t* to = candidates_.data();
      std::uint64_t any = 0;
      work_ += high_ - low_;
      if (shift == 0) {
        for (std::size_t w = low_; w < high_; ++w) any |= to[w] &= from[w];
      } else {
        for (std::size_t w = low_; w < high_; ++w)
          any |= to[w] &= (from[w] >> shift) | (from[w + 1] << (64 - shift));
      }
      if (any == 0) return false;
    }
  }
  while (candidates_[low_] == 0) ++low_;
  while (candidates_[high_ - 1] == 0) --high_;
  return true;
}

std::uint64_t BitPage::likely_feet(const std::vector<RowTest>& rows, std::int32_t y) {
  std::uint64_t feet = ~std::uint64_t{0};
  const std::size_t count = long_rows_.size() / classes_;
  std::size_t looked_at = 0;
  for (const RowTest& test : rows) {
    const auto word = static_cast<std::size_t>(y + test.row) / 64;
    const unsigned shift = static_cast<unsigned>(y + test.row) % 64;
    if (word >= count) continue;  // rows above those that exist are free
    const std::uint64_t* bits = long_rows_.data() + word * classes_ + test.length_class;
    std::uint64_t free = bits[0] >> shift;
    if (shift > 0) free |= (word + 1 < count ? bits[classes_] : ~std::uint64_t{0}) << (64 - shift);
    feet &= free;
    ++looked_at;
    if (feet == 0) break;
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

bool BitPage::find_in_row(const Mask& mask, const std::vector<RowTest>& rows, Window window,
                          std::int32_t y, Place& place) {
  all_candidates(window.x0, window.x1);
  for (const RowTest& test : rows)
    if (y + test.row < rows_ && !row_allows(mask, test.row, y + test.row)) return false;
  while (candidates_[low_] == 0) ++low_;
  place = {static_cast<std::int32_t>(64 * low_) + std::countr_zero(candidates_[low_]), y};
  return true;
}

bool BitPage::find(const Mask& mask, const std::vector<RowTest>& rows, Window window,
                   Place& place) {
  window.x0 = std::max(0, window.x0);
  window.x1 = std::min(window.x1, width_ - mask.width);
  window.y1 = std::min(window.y1, height_ - mask.height);
  if (window.x0 > window.x1) return false;
  for (std::int32_t y = std::max(0, window.y0); y <= window.y1; y += 64)
    for (std::uint64_t feet = likely_feet(rows, y); feet != 0; feet &= feet - 1) {
      const std::int32_t foot = y + std::countr_zero(feet);
      if (foot > window.y1) return false;
      if (find_in_row(mask, rows, window, foot, place)) return true;
    }
  return false;
}

// Length of the longest run of ones in level 0.
std::int32_t BitPage::longest_free(std::int32_t y) const {
  const std::uint64_t* bits = row(0, y);
  std::int32_t longest = 0, current = 0;
  for (std::size_t w = 0; w < words_; ++w) {
    std::uint64_t word = bits[w];
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
      const int ones = std::countr_one(word);  // below 64: the word is not all ones
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

// Number of cells of row y within [begin, end) that are taken.
std::int32_t BitPage::taken(std::int32_t y, std::int32_t begin, std::int32_t end) const {
  if (y < 0) return end - begin;
  if (y >= rows_) return 0;
  const std::uint64_t* bits = row(0, y);
  std::int32_t count = 0;
  for (std::int32_t x = begin; x < end;) {
    const std::int32_t n = std::min(64 - x % 64, end - x);
    const std::uint64_t ones = n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
    count += std::popcount(~(bits[x / 64] >> (x % 64)) & ones);
    x += n;
  }
  return count;
}

double BitPage::contact(const Mask& mask, Place place) const {
  std::int64_t touching = 0, outline = 0;
  for (std::int32_t r = 0; r < mask.height; ++r) {
    const std::int32_t y = place.y + r;
    for (const Run& run : mask.row(r)) {
      const std::int32_t begin = place.x + run.begin, end = place.x + run.end;
      touching += begin == 0 || taken(y, begin - 1, begin);
      touching += end == width_ || taken(y, end, end + 1);
      touching += taken(y - 1, begin, end) + taken(y + 1, begin, end);
      outline += 2;
    }
  }
  return static_cast<double>(touching) / static_cast<double>(outline + 2 * mask.width);
}

// Derives the levels of a row from level 0, where cells [begin, end) have changed.
void BitPage::rebuild(std::int32_t y, std::int32_t begin, std::int32_t end) {
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
  set_longest(y, longest_free(y));
  work_ += static_cast<std::uint64_t>(levels_) * (last - static_cast<std::size_t>(begin) / 64);
}

void BitPage::put(const Mask& mask, Place place) {
  grow(place.y + mask.height);
  used_height_ = std::max(used_height_, place.y + mask.height);
  for (std::int32_t r = 0; r < mask.height; ++r) {
    std::uint64_t* bits = row(0, place.y + r);
    for (const Run& run : mask.row(r))
      for (std::int32_t x = place.x + run.begin; x < place.x + run.end;) {
        const std::int32_t n = std::min(64 - x % 64, place.x + run.end - x);
        bits[x / 64] &= ~((n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1) << (x % 64));
        x += n;
      }
    rebuild(place.y + r, place.x, place.x + mask.width);
  }
}

void BitPage::take_away(const Mask& mask, Place place) {
  for (std::int32_t r = 0; r < mask.height; ++r) {
    std::uint64_t* bits = row(0, place.y + r);
    for (const Run& run : mask.row(r))
      for (std::int32_t x = place.x + run.begin; x < place.x + run.end;) {
        const std::int32_t n = std::min(64 - x % 64, place.x + run.end - x);
        bits[x / 64] |= (n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1) << (x % 64);
        x += n;
      }
    rebuild(place.y + r, place.x, place.x + mask.width);
  }
}

bool BitPage::is_free(std::int32_t x, std::int32_t y) const {
  return y >= rows_ || (row(0, y)[x / 64] >> (x % 64) & 1);
}

}  // namespace atlas::pack
