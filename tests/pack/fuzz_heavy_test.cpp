#include <gtest/gtest.h>

#include "tests/pack/layout_fuzz.h"

namespace atlas {
namespace {

TEST(PackFuzz, MillionOperationSequences) {
  for (std::uint64_t seed = 0; seed < 1000000; ++seed)
    ASSERT_EQ(test::fuzz_layout(seed), "") << "seed " << seed;
}

TEST(PackFuzz, MillionRectangleSets) {
  for (std::uint64_t seed = 0; seed < 1000000; ++seed)
    ASSERT_EQ(test::fuzz_rects(seed), "") << "seed " << seed;
}

TEST(PackFuzz, ThousandsOfOutlineSets) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed)
    ASSERT_EQ(test::fuzz_outlines(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace atlas
