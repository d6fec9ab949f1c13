#include "libatlas/core/disjoint_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace atlas {
namespace {

TEST(DisjointSets, JoinInAnyOrderToTheLeastMember) {
  std::mt19937 random(3);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<std::uint32_t> least(500);  // spread until nothing changes
  for (std::uint32_t i = 0; i < least.size(); ++i) least[i] = i;
  for (int i = 0; i < 300; ++i) pairs.push_back({random() % 500, random() % 500});
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : pairs) {
      changed |= least[a] != least[b];
      least[a] = least[b] = std::min(least[a], least[b]);
    }
  }
  for (int round = 0; round < 3; ++round) {
    std::shuffle(pairs.begin(), pairs.end(), random);
    DisjointSets sets(least.size());
    for (const auto& [a, b] : pairs) sets.join(a, b);
    for (std::uint32_t i = 0; i < least.size(); ++i) EXPECT_EQ(sets.find(i), least[i]);
  }
}

}  // namespace
}  // namespace atlas
