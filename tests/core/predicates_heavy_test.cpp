#include <gtest/gtest.h>

#include "tests/core/orientation_oracle.h"

namespace atlas::test {
namespace {

TEST(PredicatesHeavy, OrientationIsThatOfExactArithmetic) {
  const OrientationCount count = compare_orientations(10'000'000, 1);
  EXPECT_EQ(count.different, 0);
  EXPECT_GT(count.collinear, 100'000);
}

}  // namespace
}  // namespace atlas::test
