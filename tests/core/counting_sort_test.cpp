#include "libatlas/core/counting_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace atlas {
namespace {

TEST(CountingSort, AgreesWithAStableSort) {
  std::mt19937 random(7);
  for (const std::size_t buckets : {1u, 2u, 7u, 1000u}) {
    for (const std::size_t items : {0u, 1u, 30u, 3000u}) {
      std::vector<std::uint32_t> key(items), order(items);
      for (auto& k : key) k = random() % std::uint32_t(buckets);
      std::iota(order.begin(), order.end(), 0u);
      std::stable_sort(order.begin(), order.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
      const Buckets sorted =
          sort_into_buckets(items, buckets, [&](std::size_t i) { return key[i]; });
      EXPECT_EQ(sorted.items, order);
      ASSERT_EQ(sorted.size(), buckets);
      std::size_t seen = 0;
      for (std::uint32_t b = 0; b < buckets; ++b) {
        EXPECT_EQ(sorted.begin[b], seen);
        for (const std::uint32_t i : sorted[b]) EXPECT_EQ(key[i], b);
        seen += sorted[b].size();
      }
      EXPECT_EQ(seen, items);
    }
  }
  EXPECT_EQ(sort_into_buckets(0, 0, [](std::size_t) { return 0u; }).size(), 0u);
}

}  // namespace
}  // namespace atlas
