#include "libatlas/view/hand_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace atlas {
namespace {

double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

double length(const Vec3d& v) {
  return std::sqrt(dot(v, v));
}

const Vec3d kUps[] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, -3}, {2, 0.1, -0.3}};

TEST(HandLight, StandsAtItsElevationAndTurnsAroundTheVertical) {
  constexpr double kDegree = std::numbers::pi / 180;
  for (const Vec3d& up : kUps) {
    for (const float elevation : {-60.0f, 0.0f, 35.0f}) {
      const Vec3d first = hand_direction({20, elevation}, up);
      EXPECT_NEAR(length(first), 1, 1e-12);
      EXPECT_NEAR(dot(first, up) / length(up), std::sin(elevation * kDegree), 1e-7);
      // The chord of a circle with the radius cos(elevation), over 70 degrees of it.
      const Vec3d second = hand_direction({90, elevation}, up);
      const Vec3d chord = {first.x - second.x, first.y - second.y, first.z - second.z};
      EXPECT_NEAR(length(chord), 2 * std::cos(elevation * kDegree) * std::sin(35 * kDegree), 1e-7);
    }
  }
}

// When the hand takes the light, it stays where its path has brought it.
TEST(HandLight, TakesOverTheDirectionOfTheMovingLight) {
  for (const Vec3d& up : kUps) {
    for (const Vec3d& from : {Vec3d{0.3, 0.5, -0.2}, {-4, 0.1, 0.7}, {0.2, -1, -1}, {1, 1, 1}}) {
      const HandLight light = hand_light_of(from, up);
      EXPECT_GE(light.azimuth, 0);
      EXPECT_LE(light.azimuth, 360);
      EXPECT_NEAR(dot(hand_direction(light, up), from) / length(from), 1, 1e-9);
    }
    EXPECT_EQ(hand_light_of(up, up).elevation, kSteepestHandLight);
    EXPECT_EQ(hand_light_of({-up.x, -up.y, -up.z}, up).elevation, -kSteepestHandLight);
  }
}

}  // namespace
}  // namespace atlas
