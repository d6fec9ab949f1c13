#include "libatlas/core/bounds.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "libatlas/core/rect.h"

namespace atlas {
namespace {

TEST(Bounds, AreTheSmallestBoxAroundThePoints) {
  Bounds<glm::vec3> box;
  for (const glm::vec3 p : {glm::vec3(1, 5, -2), glm::vec3(3, 4, -2), glm::vec3(2, 7, -3)})
    box.add(p);
  EXPECT_EQ(box.low, glm::vec3(1, 4, -3));
  EXPECT_EQ(box.high, glm::vec3(3, 7, -2));
  EXPECT_EQ(box.size(), glm::vec3(2, 3, 1));
}

TEST(Bounds, MeetWhatTheyTouchAndWhatIsWithinReach) {
  const Bounds<glm::dvec2> box{{0, 0}, {2, 1}}, beside{{2, 1}, {3, 3}}, apart{{2.5, 0}, {3, 1}};
  EXPECT_TRUE(box.meets(box));
  EXPECT_TRUE(box.meets(beside));
  EXPECT_FALSE(box.meets(apart));
  EXPECT_FALSE(apart.meets(box, 0.25));
  EXPECT_TRUE(apart.meets(box, 0.5));
}

TEST(Bounds, WithoutPointsMeetNothing) {
  const Bounds<glm::dvec2> none, large{glm::dvec2(-1e300), glm::dvec2(1e300)};
  EXPECT_FALSE(none.meets(large));
  EXPECT_FALSE(large.meets(none, 1));
  EXPECT_FALSE(none.meets(none));
}

TEST(Rect, Edges) {
  const Rect r{-2, 3, 65536, 65536};
  EXPECT_EQ(r.right(), 65534);
  EXPECT_EQ(r.top(), 65539);
  EXPECT_EQ(r.area(), std::int64_t{1} << 32);
}

}  // namespace
}  // namespace atlas
