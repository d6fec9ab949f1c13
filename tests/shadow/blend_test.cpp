#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "libatlas/shadow/blend.h"

namespace atlas {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr KeyBlend kAll[] = {KeyBlend::linear, KeyBlend::slerp_raw, KeyBlend::slerp_normalised};

TEST(Blend, EndsSelectOneKey) {
  for (KeyBlend blend : kAll)
    for (double angle : {0.0, 1e-9, 1e-3, 0.5, kPi / 2, 3.0, kPi}) {
      const BlendWeights a = blend_weights(blend, 0, angle), b = blend_weights(blend, 1, angle);
      EXPECT_NEAR(a.from, 1, 1e-15);
      EXPECT_NEAR(a.to, 0, 1e-15);
      EXPECT_NEAR(b.from, 0, 1e-15);
      EXPECT_NEAR(b.to, 1, 1e-15);
    }
}

// The raw weights must rotate one unit vector into the other. That is the definition of SLERP
// (Shoemake 1985), and does not use the formula under test.
TEST(Blend, RawSphericalWeightsStayOnTheArc) {
  for (double angle = 0.001; angle <= kPi / 2; angle += 0.05)
    for (double t = 0; t <= 1; t += 0.125) {
      const BlendWeights w = blend_weights(KeyBlend::slerp_raw, t, angle);
      const double x = w.from + w.to * std::cos(angle), y = w.to * std::sin(angle);
      EXPECT_NEAR(std::hypot(x, y), 1, 1e-12);
      EXPECT_NEAR(std::atan2(y, x), t * angle, 1e-12);
    }
}

TEST(Blend, SumsAreOneExceptForTheRawForm) {
  for (double angle : {0.01, 0.07, 0.5, kPi / 2}) {
    const BlendWeights raw = blend_weights(KeyBlend::slerp_raw, 0.5, angle);
    EXPECT_NEAR(raw.from + raw.to, 1 / std::cos(angle / 2), 1e-12);
    EXPECT_GT(raw.from + raw.to, 1);
    for (double t = 0; t <= 1; t += 0.1) {
      const BlendWeights n = blend_weights(KeyBlend::slerp_normalised, t, angle);
      const BlendWeights l = blend_weights(KeyBlend::linear, t, angle);
      EXPECT_NEAR(n.from + n.to, 1, 1e-15);
      EXPECT_NEAR(l.from + l.to, 1, 1e-15);
    }
  }
}

TEST(Blend, FiniteAndContinuousWhereTheFormulaIsNot) {
  for (KeyBlend blend : kAll)
    for (double angle : {0.0, 1e-300, 1e-12, 0.99e-4, 1.01e-4, kPi - 1e-9, kPi, 2 * kPi, -1.0, kNan,
                         std::numeric_limits<double>::infinity()})
      for (double t :
           {-1.0, 0.0, 0.25, 0.5, 1.0, 2.0, kNan, -std::numeric_limits<double>::infinity()}) {
        const BlendWeights w = blend_weights(blend, t, angle);
        EXPECT_TRUE(w.from >= 0 && w.from <= 1) << angle << " " << t;
        EXPECT_TRUE(w.to >= 0 && w.to <= 1) << angle << " " << t;
      }
  // There must be no visible step where the linear weights begin.
  const BlendWeights below = blend_weights(KeyBlend::slerp_raw, 0.3, 0.99e-4);
  const BlendWeights above = blend_weights(KeyBlend::slerp_raw, 0.3, 1.01e-4);
  EXPECT_NEAR(below.from, above.from, 1e-8);
  EXPECT_NEAR(below.to, above.to, 1e-8);
}

// Beyond 90 degrees the spherical weights would grow without bound.
TEST(Blend, KeysTooFarApartAreBlendedLinearly) {
  for (const KeyBlend blend : kAll)
    for (const double angle : {kPi / 2 + 1e-6, 2.0, 3.0}) {
      const BlendWeights w = blend_weights(blend, 0.25, angle);
      EXPECT_EQ(w.from, 0.75) << angle;
      EXPECT_EQ(w.to, 0.25) << angle;
    }
}

TEST(Blend, TimeOutsideTheIntervalIsClamped) {
  for (KeyBlend blend : kAll) {
    EXPECT_EQ(blend_weights(blend, -3, 0.4).from, blend_weights(blend, 0, 0.4).from);
    EXPECT_EQ(blend_weights(blend, 7, 0.4).to, blend_weights(blend, 1, 0.4).to);
    EXPECT_EQ(blend_weights(blend, kNan, 0.4).from, 1);
  }
}

TEST(Blend, ALitPointIsNeverBrighterThanLit) {
  const BlendWeights raw = blend_weights(KeyBlend::slerp_raw, 0.5, kPi / 2);
  EXPECT_NEAR(raw.from + raw.to, std::sqrt(2.0), 1e-12);
  EXPECT_EQ(blend_visibility(raw, 1, 1), 1);
  EXPECT_EQ(blend_visibility(raw, 0, 0), 0);
  EXPECT_NEAR(blend_visibility(raw, 1, 0), std::sqrt(0.5), 1e-12);
  EXPECT_EQ(blend_visibility({0.5, 0.5}, kNan, 1), 0);
}

TEST(Blend, AnglesNearZeroAndPi) {
  EXPECT_EQ(angle_between({1, 2, 3}, {1, 2, 3}), 0);
  EXPECT_NEAR(angle_between({1, 0, 0}, {-5, 0, 0}), kPi, 1e-15);
  EXPECT_NEAR(angle_between({1, 0, 0}, {1, 1e-9, 0}), 1e-9, 1e-15);
  EXPECT_NEAR(angle_between({1, 0, 0}, {-1, 1e-9, 0}), kPi - 1e-9, 1e-15);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vec3d& bad :
       {Vec3d{0, 0, 0}, Vec3d{kNan, 0, 0}, Vec3d{0, infinity, 0}, Vec3d{1, 1, kNan}}) {
    EXPECT_EQ(angle_between(bad, {1, 0, 0}), 0);
    EXPECT_EQ(angle_between({1, 0, 0}, bad), 0);
  }
  EXPECT_NEAR(angle_between({1e-200, 0, 0}, {0, 1e200, 0}), kPi / 2, 1e-12);
}

}  // namespace
}  // namespace atlas
