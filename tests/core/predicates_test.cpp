#include "libatlas/core/predicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "tests/core/orientation_oracle.h"

namespace atlas {
namespace {

// Integers that are small enough for exact 64-bit determinants give the expected sign. The
// predicate gets them moved by a power of two, so that doubles still represent them but naive
// products round.
TEST(Predicates, OrientationIsExact) {
  std::mt19937_64 random(4);
  std::uniform_int_distribution<std::int64_t> small(-3, 3);
  const double moved = std::exp2(51);
  for (int i = 0; i < 20000; ++i) {
    const std::int64_t c[6] = {small(random), small(random), small(random),
                               small(random), small(random), small(random)};
    const std::int64_t det = (c[2] - c[0]) * (c[5] - c[1]) - (c[3] - c[1]) * (c[4] - c[0]);
    const auto at = [&](int k) { return Vec2d{moved + double(c[k]), moved + double(c[k + 1])}; };
    EXPECT_EQ(orientation(at(0), at(2), at(4)), (det > 0) - (det < 0));
  }
  const double e = std::exp2(-53);
  EXPECT_EQ(orientation({0, 0}, {1, 1}, {0.5, 0.5 + e}), 1);
  EXPECT_EQ(orientation({0, 0}, {1, 1}, {0.5, 0.5}), 0);
  EXPECT_EQ(orientation({1e-300, 0}, {1, 1e300}, {1e-300, 0}), 0);
}

TEST(Predicates, OrientationIsThatOfExactArithmetic) {
  const test::OrientationCount count = test::compare_orientations(100'000, 2);
  EXPECT_EQ(count.different, 0);
  EXPECT_GT(count.collinear, 1000);
}

TEST(Predicates, SegmentsCross) {
  EXPECT_TRUE(segments_cross({0, 0}, {2, 2}, {0, 2}, {2, 0}));
  EXPECT_FALSE(segments_cross({0, 0}, {1, 1}, {2, 0}, {3, 5}));
  EXPECT_FALSE(segments_cross({0, 0}, {1, 1}, {1, 1}, {2, 0}));  // a shared end
  EXPECT_TRUE(segments_cross({0, 0}, {3, 0}, {1, 0}, {5, 0}));   // an overlap along a part
  EXPECT_FALSE(segments_cross({0, 0}, {1, 0}, {1, 0}, {2, 0}));  // end to end on one line
  EXPECT_FALSE(segments_cross({0, 0}, {1, 0}, {2, 0}, {3, 0}));
}

// Returns whether the segments share a point that is not an end of both, or are equal. Computed
// from the signs of integers, independently of the method of the predicate.
bool cross_by_integers(const int (&c)[8]) {
  const auto side = [&](int a, int b, int p) {
    const int det = (c[b] - c[a]) * (c[p + 1] - c[a + 1]) - (c[b + 1] - c[a + 1]) * (c[p] - c[a]);
    return (det > 0) - (det < 0);
  };
  const auto inside = [&](int a, int b, int p) {  // strictly between a and b, on their line
    const int along = (c[p] - c[a]) * (c[b] - c[a]) + (c[p + 1] - c[a + 1]) * (c[b + 1] - c[a + 1]);
    const int square =
        (c[b] - c[a]) * (c[b] - c[a]) + (c[b + 1] - c[a + 1]) * (c[b + 1] - c[a + 1]);
    return side(a, b, p) == 0 && along > 0 && along < square;
  };
  const auto same = [&](int a, int b) { return c[a] == c[b] && c[a + 1] == c[b + 1]; };
  if (side(0, 2, 4) * side(0, 2, 6) < 0 && side(4, 6, 0) * side(4, 6, 2) < 0) return true;
  if (inside(0, 2, 4) || inside(0, 2, 6) || inside(4, 6, 0) || inside(4, 6, 2)) return true;
  const bool twice = (same(0, 4) && same(2, 6)) || (same(0, 6) && same(2, 4));
  return twice && !same(0, 2);
}

// All pairs of segments on a small grid: ends on ends, ends inside, collinear ones, points.
TEST(Predicates, SegmentsCrossAsIntegersSay) {
  constexpr int kSide = 4;
  const double moved = std::exp2(50);
  int crossing = 0;
  for (int code = 0; code < 1 << 16; ++code) {
    int c[8];
    for (int k = 0; k < 8; ++k) c[k] = code >> (2 * k) & (kSide - 1);
    const auto at = [&](int k) { return Vec2d{moved + double(c[k]), double(c[k + 1]) - moved}; };
    const bool expected = cross_by_integers(c);
    ASSERT_EQ(segments_cross(at(0), at(2), at(4), at(6)), expected) << code;
    crossing += expected;
  }
  EXPECT_GT(crossing, 1000);
}

}  // namespace
}  // namespace atlas
