#include <gtest/gtest.h>

#include "tests/pack/layout_fuzz.h"

namespace atlas {
namespace {

TEST(PackFuzz, MillionOperationSequences) {
  for (std::uint64_t seed = 0; seed < 1000000; ++seed)
    ASSERT_EQ(test::fuzz_layout(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace atlas
