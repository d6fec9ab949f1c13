// Internal: FirstIndex, a hash table that finds the index of the first element with a given key.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/no_index.h"

namespace atlas {

// A hash of 32-bit words whose low bits depend on all words.
template <std::size_t N>
std::uint64_t hash_words(const std::array<std::uint32_t, N>& words) {
  std::uint64_t h = 0;
  for (const std::uint32_t word : words) h = (h ^ (h >> 32) ^ word) * 0xd6e8feb86659fd93u;
  return h ^ (h >> 32);
}

// The bits of a number. -0 has those of 0.
inline std::uint32_t word_of(float x) {
  return std::bit_cast<std::uint32_t>(x + 0.0f);
}

// Open addressing. The table holds indices only; the caller keeps the elements with their keys.
class FirstIndex {
 public:
  // Holds up to `most` elements. At least half of the table stays empty, so searches are short.
  explicit FirstIndex(std::size_t most = 0)
      : table_(std::bit_ceil(std::max<std::size_t>(16, 2 * most)), kNoIndex) {}

  // How many elements the table holds at most.
  std::size_t most() const { return table_.size() / 2; }

  // Returns the entry of the element whose key has this hash and for whose index `same(index)` is
  // true. If there is none, the entry is kNoIndex, and the caller sets it to the new element's
  // index.
  template <class Same>
  std::uint32_t& find(std::uint64_t hash, const Same& same) {
    const std::size_t mask = table_.size() - 1;
    for (std::size_t at = hash & mask;; at = (at + 1) & mask)
      if (table_[at] == kNoIndex || same(table_[at])) return table_[at];
  }

 private:
  std::vector<std::uint32_t> table_;
};

}  // namespace atlas
