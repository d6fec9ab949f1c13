#include "libatlas/core/first_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace atlas {
namespace {

using Key = std::array<std::uint32_t, 3>;

std::uint32_t first_with(FirstIndex& table, std::vector<Key>& keys, const Key& key) {
  std::uint32_t& entry =
      table.find(hash_words(key), [&](std::uint32_t i) { return keys[i] == key; });
  if (entry == kNoIndex) {
    entry = static_cast<std::uint32_t>(keys.size());
    keys.push_back(key);
  }
  return entry;
}

TEST(FirstIndex, NumbersKeysByFirstUse) {
  std::mt19937 random(3);
  for (const std::uint32_t range : {2u, 9u, 1u << 31}) {
    constexpr std::size_t kCount = 5000;
    FirstIndex table(kCount);
    EXPECT_GE(table.most(), kCount);
    std::vector<Key> keys;
    std::map<Key, std::uint32_t> expected;
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto word = [&] { return static_cast<std::uint32_t>(random() % range); };
      const Key key{word(), word(), word()};
      const auto number = static_cast<std::uint32_t>(expected.size());
      EXPECT_EQ(first_with(table, keys, key), expected.try_emplace(key, number).first->second);
    }
  }
}

// A table that is as full as it may be still ends each search.
TEST(FirstIndex, HoldsAsManyAsItSays) {
  FirstIndex table;
  std::vector<Key> keys;
  for (std::uint32_t i = 0; i < table.most(); ++i) EXPECT_EQ(first_with(table, keys, {i, 0, 0}), i);
  for (std::uint32_t i = 0; i < table.most(); ++i) EXPECT_EQ(first_with(table, keys, {i, 0, 0}), i);
  EXPECT_EQ(*std::max_element(keys.begin(), keys.end()), (Key{std::uint32_t(table.most() - 1)}));
}

// Coordinates of regular grids have many zero bits at their end. The slots are the low bits of the
// hash.
TEST(FirstIndex, WordsOfGridsSpread) {
  std::vector<int> slots(1 << 12, 0);
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 16; ++y)
      for (int z = 0; z < 16; ++z)
        ++slots[hash_words<3>({word_of(float(x)), word_of(float(y)), word_of(float(z))}) &
                (slots.size() - 1)];
  EXPECT_LE(*std::max_element(slots.begin(), slots.end()), 8);
}

TEST(FirstIndex, TheWordOfNegativeZeroIsThatOfZero) {
  EXPECT_EQ(word_of(-0.0f), word_of(0.0f));
  EXPECT_NE(word_of(-1.0f), word_of(1.0f));
}

}  // namespace
}  // namespace atlas
