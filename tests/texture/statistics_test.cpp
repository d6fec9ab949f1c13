#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/texture/tone.h"
#include "tests/support/lit_shapes.h"

namespace atlas {
namespace {

LuminanceStatistics measure(const LitShape& shape) {
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const auto s = measure_luminance(sampler, Context{});
  EXPECT_TRUE(s.ok());
  return *s;
}

// The illumination of a box: of its floor, and of its other sides.
struct BoxLight {
  float sides, floor;
};

// Adds a closed box of six sheets with its corner at `at`.
void add_box(LitShape& to, Vec3f at, float size, BoxLight light) {
  for (int side = 0; side < 6; ++side) {
    const float v = side == 0 ? light.floor : light.sides;
    LitShape sheet = make_sheet({size, size, 2, 2}, [&](double, double) { return Vec3f{v, v, v}; });
    for (Vec3f& p : sheet.scene.positions) {
      const float far = side % 2 ? size : 0.0f;
      if (side / 2 == 0) p = {p.x, p.y, far};
      if (side / 2 == 1) p = {p.x, far, p.y};
      if (side / 2 == 2) p = {far, p.x, p.y};
    }
    append(to, sheet, at);
  }
}

TEST(Statistics, AreWeightedByArea) {
  // Three quarters of the lit area are at 1 and one quarter is at 4. As much area is unlit as lit.
  LitShape shape = make_sheet({3, 1, 7, 2}, [](double, double) { return Vec3f{1, 1, 1}; });
  append(shape,
         make_sheet({1, 1, 30, 30},
                    [](double, double) {
                      return Vec3f{4, 4, 4};
                    }),
         {9, 0, 0});
  append(shape, make_sheet({4, 1, 1, 1}, [](double, double) { return Vec3f{}; }), {20, 0, 0});
  const LuminanceStatistics s = measure(shape);
  EXPECT_NEAR(s.lit_area, 4, 0.001);
  EXPECT_NEAR(s.unlit_area, 4, 0.001);
  EXPECT_NEAR(s.mean, 1.75, 0.001);
  EXPECT_NEAR(s.log_average, std::pow(4.0, 0.25), 0.001);
  EXPECT_NEAR(s.maximum, 4, 1e-5);
  EXPECT_NEAR(s.percentile98, 4, 1e-5);
  EXPECT_NEAR(s.median, 1, 1e-5);
  EXPECT_FALSE(s.seen);  // sheets in one plane enclose no space
  EXPECT_EQ(s.not_finite, 0u);
}

TEST(Statistics, LeaveOutWhatIsClosedIn) {
  // A room at 1 with a bright floor at 2 contains small closed boxes, which are lit inside at 50.
  LitShape room;
  add_box(room, {0, 0, 0}, 10, {1, 2});
  for (int i = 0; i < 6; ++i) add_box(room, {1.5f + static_cast<float>(i), 5, 5}, 0.7f, {50, 50});
  const LuminanceStatistics s = measure(room);
  EXPECT_TRUE(s.seen);
  // The outsides of the boxes are the same surface, so a few sight lines do end on them. They are 3
  // % of the surface, and less of what is seen.
  EXPECT_GT(s.percentile98, 1.5);
  LitShape empty;
  add_box(empty, {0, 0, 0}, 10, {1, 2});
  EXPECT_NEAR(measure(empty).percentile98, 2, 1e-5);
}

TEST(Statistics, DoNotChangeWithScaleOrPlace) {
  const auto room = [](float scale, Vec3f at) {
    LitShape out;
    add_box(out, at, 4 * scale, {1, 1});
    for (std::size_t i = 0; i < out.scene.positions.size(); ++i) {
      const Vec3f p = out.scene.positions[i];
      const float v = 1 + std::fabs(p.x - at.x) / scale + std::fabs(p.z - at.z) / scale;
      out.scene.illumination[i] = {v, v / 2, 0};
    }
    return measure(out);
  };
  const LuminanceStatistics a = room(1, {}), b = room(0x1p-10f, {}), c = room(0x1p12f, {});
  EXPECT_TRUE(a.seen);
  EXPECT_EQ(a.percentile98, b.percentile98);
  EXPECT_EQ(a.percentile98, c.percentile98);
  EXPECT_EQ(a.log_average, b.log_average);
  EXPECT_NEAR(room(1, {64, 0, 0}).percentile98, a.percentile98, 0.05 * a.percentile98);
}

TEST(Statistics, CountWhatIsNoLuminance) {
  LitShape shape = make_sheet({2, 1, 2, 1}, [](double u, double) {
    return u == 0 ? Vec3f{NAN, 1, 1} : u == 2 ? Vec3f{-3, -3, -3} : Vec3f{1, 1, 1};
  });
  const LuminanceStatistics s = measure(shape);
  // Every triangle of the left half has a corner that is no number. In the right half, light falls
  // from 1 to -3, so three quarters of it are negative.
  const auto samples = static_cast<double>(1 << 18);
  EXPECT_NEAR(static_cast<double>(s.not_finite), samples / 2, 0.001 * samples);
  EXPECT_NEAR(static_cast<double>(s.negative), 0.375 * samples, 0.001 * samples);
  EXPECT_LE(s.percentile98, 1);
  EXPECT_NEAR(s.lit_area, 0.25, 0.002);
  EXPECT_NEAR(s.unlit_area, 0.75, 0.002);
}

TEST(Statistics, AnyNegativeChannelCounts) {
  for (int channel = 0; channel < 3; ++channel) {
    const LitShape shape = make_sheet({1, 1, 1, 1}, [channel](double, double) {
      Vec3f light{1, 1, 1};
      (channel == 0 ? light.x : channel == 1 ? light.y : light.z) = -1;
      return light;
    });
    EXPECT_EQ(measure(shape).negative, std::uint64_t{1} << 18) << channel;
  }
}

// Light that rises evenly from 0 to 1000 from one side of a sheet to the other.
TEST(Statistics, PercentilesAreSharesOfTheArea) {
  const LitShape shape = make_sheet({1, 1, 1, 1}, [](double u, double) {
    const auto v = static_cast<float>(1000 * u);
    return Vec3f{v, v, v};
  });
  const LuminanceStatistics s = measure(shape);
  EXPECT_NEAR(s.median, 500, 1);
  EXPECT_NEAR(s.percentile98, 980, 0.2);
  EXPECT_NEAR(s.percentile99, 990, 0.2);
  EXPECT_NEAR(s.maximum, 1000, 0.1);
  EXPECT_NEAR(s.minimum_log, std::log(10), 0.02);
  EXPECT_NEAR(s.maximum_log, std::log(990), 0.001);
}

// Returns the statistics of a sheet of which the given shares of the area have the given light,
// from one side on.
LuminanceStatistics of_shares(std::vector<std::pair<double, float>> shares) {
  LitShape shape;
  float at = 0;
  for (const auto& [share, v] : shares) {
    append(shape,
           make_sheet({share, 1, 2, 2},
                      [v](double, double) {
                        return Vec3f{v, v, v};
                      }),
           {at, 0, 0});
    at += float(share) + 1;
  }
  return measure(shape);
}

// Neither a hot spot nor darkness beside what is lit moves the middle, and neither does how bright
// or dark they are.
TEST(Statistics, TheMiddleIsThatOfWhatIsLit) {
  for (const float spot : {500.0f, 1e6f})
    for (const float dark : {0.05f, 1e-6f}) {
      const LuminanceStatistics s =
          of_shares({{0.04, spot}, {0.12, 20.0f}, {0.12, 10.0f}, {0.12, 8.0f}, {0.6, dark}});
      EXPECT_NEAR(s.middle, 10, 1e-4) << spot << ' ' << dark;
      EXPECT_NEAR(s.median, dark, 1e-6);
    }
  // Shadows of a tenth are lit.
  EXPECT_NEAR(of_shares({{0.4, 10.0f}, {0.6, 1.0f}}).middle, 1, 1e-5);
}

// Exposure is of what eyes see: the luma of colours, not their largest channel.
TEST(Statistics, TheMiddleIsOfLuma) {
  const LuminanceStatistics s = measure(make_sheet({1, 1, 2, 2}, [](double, double) {
    return Vec3f{10, 0, 0};
  }));
  EXPECT_NEAR(s.middle, 2.126, 1e-3);
  EXPECT_NEAR(s.median, 2.126, 1e-3);
  EXPECT_NEAR(s.percentile98, 10, 1e-4);
}

// The luma of the smallest red is 0 in single precision.
TEST(Statistics, OfDenormalLightAreFinite) {
  const LuminanceStatistics s = measure(make_sheet({2, 1, 2, 1}, [](double u, double) {
    return u < 1 ? Vec3f{1e-45f, 0, 0} : Vec3f{1, 1, 1};
  }));
  EXPECT_TRUE(std::isfinite(s.minimum_log));
  EXPECT_TRUE(std::isfinite(s.log_average));
  const LuminanceStatistics dim = measure(make_sheet({1, 1, 1, 1}, [](double, double) {
    return Vec3f{1e-45f, 0, 0};
  }));
  EXPECT_GT(dim.lit_area, 0);
  EXPECT_TRUE(std::isfinite(dim.minimum_log) && std::isfinite(dim.maximum_log));
}

TEST(Statistics, OfADarkSceneAreZero) {
  const LuminanceStatistics s =
      measure(make_sheet({2, 1, 2, 1}, [](double, double) { return Vec3f{}; }));
  EXPECT_EQ(s.lit_area, 0);
  EXPECT_NEAR(s.unlit_area, 2, 1e-6);
  EXPECT_EQ(s.maximum, 0);
  EXPECT_EQ(s.percentile98, 0);
  EXPECT_EQ(s.middle, 0);
  EXPECT_EQ(s.log_average, 0);
  EXPECT_FALSE(s.seen);
}

TEST(Statistics, NeedSurface) {
  LitShape shape = make_sheet({1, 1, 1, 1}, [](double, double) { return Vec3f{1, 1, 1}; });
  for (Vec3f& p : shape.scene.positions) p = {1, 2, 3};
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const auto s = measure_luminance(sampler, Context{});
  ASSERT_FALSE(s.ok());
  EXPECT_EQ(s.status().code(), ErrorCode::bad_input);
}

TEST(Statistics, StopWhenCancelled) {
  const LitShape shape = make_sheet({1, 1, 4, 4}, [](double, double) { return Vec3f{1, 1, 1}; });
  const LuminanceSampler sampler(shape.scene, Quantity::illuminance);
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  EXPECT_EQ(measure_luminance(sampler, context).status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas
