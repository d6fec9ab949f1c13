#include <gtest/gtest.h>

#include "tests/pack/layout_fuzz.h"

namespace atlas {
namespace {

TEST(PackFuzz, MillionOperationSequences) {
  for (std::uint64_t seed = 0; seed < 1000000; ++seed)
    ASSERT_EQ(test::fuzz_layout(seed), "") << "seed " << seed;
}

// A million sets in all, in cases that end well before the time limit of a test, even when several
// run at once.
constexpr std::uint64_t kRectangleSets = 1000000, kRectangleCases = 10;

class PackRectangleFuzz : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(PackRectangleFuzz, ManySets) {
  constexpr std::uint64_t count = kRectangleSets / kRectangleCases;
  for (std::uint64_t seed = count * GetParam(); seed < count * (GetParam() + 1); ++seed)
    ASSERT_EQ(test::fuzz_rects(seed), "") << "seed " << seed;
}

INSTANTIATE_TEST_SUITE_P(Tenths, PackRectangleFuzz,
                         ::testing::Range(std::uint64_t{0}, kRectangleCases));

TEST(PackFuzz, ThousandsOfOutlineSets) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed)
    ASSERT_EQ(test::fuzz_outlines(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace atlas
