#include "libatlas/texture/tone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/lanes.h"

namespace atlas {
namespace {

constexpr ToneOperator kAll[] = {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago,
                                 ToneOperator::reinhard_devlin};

LuminanceStatistics statistics(double scale) {
  LuminanceStatistics s;
  s.lit_area = 1;
  s.percentile98 = 2 * scale;
  s.middle = 0.3 * scale;
  s.maximum = 10 * scale;
  s.log_average = 0.3 * scale;
  s.mean = 0.5 * scale;
  const auto mean = static_cast<float>(0.5 * scale);
  s.mean_rgb = {mean, mean, mean};
  s.minimum_log = std::log(0.01 * scale);
  s.maximum_log = std::log(5 * scale);
  return s;
}

ToneMapping mapping(ToneOperator op, double scale, ToneOptions options = {}) {
  options.op = op;
  auto tone = make_tone_mapping(options, statistics(scale));
  EXPECT_TRUE(tone.ok()) << tone.status().message();
  return *tone;
}

TEST(ToneMapping, RisesFromBlackToWhite) {
  for (const ToneOperator op : kAll) {
    const ToneMapping tone = mapping(op, 1);
    const float white = op == ToneOperator::linear ? 2.0f : 10.0f;
    EXPECT_EQ(tone.map({0, 0, 0}), (Vec3f{0, 0, 0}));
    EXPECT_NEAR(tone.map({white, white, white}).y, 1, 1e-5) << tone_operator_name(op);
    EXPECT_LT(tone.map({0.95f * white, 0.95f * white, 0.95f * white}).y, 0.9999f);
    float last = 0;
    for (float v = 1e-6f; v < 100; v *= 1.05f) {
      const Vec3f d = tone.map({v, v, v});
      EXPECT_NEAR(d.x, d.y, 1e-5);
      EXPECT_NEAR(d.z, d.y, 1e-5);
      EXPECT_GE(d.y, last) << tone_operator_name(op) << ' ' << v;
      EXPECT_LE(d.y, 1);
      EXPECT_TRUE(d.y > last || v >= white / 1.05f) << tone_operator_name(op) << ' ' << v;
      last = d.y;
    }
  }
}

// A fiftieth of what is visible is white, unless the middle would be shown brighter than 1/4 or
// darker than 1/15 of white.
TEST(ToneMapping, AMeasuredWhiteSuitsTheMiddle) {
  const auto white = [](double middle, double percentile98) {
    LuminanceStatistics s = statistics(1);
    s.middle = middle;
    s.percentile98 = percentile98;
    s.maximum = 1e6;  // a lamp, and however bright it is
    const auto tone = make_tone_mapping({}, s);
    EXPECT_TRUE(tone.ok());
    return 1.0 / double(tone->scale);
  };
  EXPECT_NEAR(white(20, 20), 80, 1e-3);  // even light
  EXPECT_NEAR(white(20, 79), 80, 1e-3);
  EXPECT_NEAR(white(20, 150), 150, 1e-3);    // some of it is bright
  EXPECT_NEAR(white(20, 40000), 300, 1e-3);  // as sunlight on the floor
}

TEST(ToneMapping, FollowsThePublishedCurves) {
  // Reinhard et al. 2002, eq. 2 and 4.
  const ToneMapping reinhard = mapping(ToneOperator::reinhard, 1);
  const auto expect_reinhard = [&](double y) {
    const double l = 0.18 * y / 0.3, w = 0.18 * 10 / 0.3;
    const auto f = static_cast<float>(y);
    EXPECT_NEAR(reinhard.map({f, f, f}).x, std::min(1.0, l * (1 + l / (w * w)) / (1 + l)), 1e-5);
  };
  for (const double y : {0.001, 0.1, 1.0, 3.0, 9.0}) expect_reinhard(y);
  // Drago et al. 2003, eq. 4, with bias 0.85. The exponent in the interpolation of the base is
  // log(b) / log(0.5).
  const ToneMapping drago = mapping(ToneOperator::drago, 1);
  for (const double y : {0.001, 0.1, 1.0, 3.0, 9.0}) {
    const double l = y / 0.3, w = 10 / 0.3;
    const double want = std::log(l + 1) / std::log10(w + 1) /
                        std::log(2 + 8 * std::pow(l / w, std::log(0.85) / std::log(0.5)));
    const auto f = static_cast<float>(y);
    EXPECT_NEAR(drago.map({f, f, f}).x, want, 1e-5);
  }
}

// Drago et al. 2003, section 3.2: another bias also changes the luminance that the eye has adapted
// to.
TEST(ToneMapping, DragosBiasCorrectsTheAdaptation) {
  for (const double bias : {0.6, 0.75, 0.95}) {
    ToneOptions options;
    options.bias = bias;
    const ToneMapping drago = mapping(ToneOperator::drago, 1, options);
    const double adaptation = 0.3 / std::pow(1 + bias - 0.85, 5), w = 10 / adaptation;
    for (const double y : {0.01, 0.5, 4.0}) {
      const double l = y / adaptation;
      const double want = std::log(l + 1) / std::log10(w + 1) /
                          std::log(2 + 8 * std::pow(l / w, std::log(bias) / std::log(0.5)));
      const auto f = static_cast<float>(y);
      EXPECT_NEAR(drago.map({f, f, f}).x, std::min(want, 1.0), 1e-5) << bias << ' ' << y;
    }
  }
}

// Reinhard and Devlin 2005, eq. 1 to 6 and section 3, with luminance in units of the log average
// and scaled so that white is 1.
TEST(ToneMapping, PhotoreceptorsFollowThePublishedModel) {
  const double k = (std::log(5) - std::log(0.3)) / (std::log(5) - std::log(0.01));
  const double automatic = 0.3 + 0.7 * std::pow(k, 1.4);
  for (const double contrast : {0.0, 0.4, 1.0}) {
    for (const double light : {0.0, 0.5, 1.0}) {
      for (const double chromatic : {0.0, 0.3, 1.0}) {
        ToneOptions options;
        options.contrast = contrast;
        options.light_adaptation = light;
        options.chromatic_adaptation = chromatic;
        const ToneMapping tone = mapping(ToneOperator::reinhard_devlin, 1, options);
        const double m = contrast > 0 ? contrast : automatic;
        const Vec3f colour{0.8f, 0.2f, 0.1f};
        const double in[3] = {0.8 / 0.3, 0.2 / 0.3, 0.1 / 0.3};
        const double y = 0.2126 * in[0] + 0.7152 * in[1] + 0.0722 * in[2];
        const Vec3f mapped = tone.map(colour);
        const float got[3] = {mapped.x, mapped.y, mapped.z};
        // White is grey light, which adapts to itself and to the mean of 0.5.
        const double mean = chromatic * 0.5 / 0.3 + (1 - chromatic), white = 10 / 0.3;
        const double at_white = white / (white + std::pow(light * white + (1 - light), m));
        for (int c = 0; c < 3; ++c) {
          const double local = chromatic * in[c] + (1 - chromatic) * y;
          const double adaptation = light * local + (1 - light) * mean;
          const double want = in[c] / (in[c] + std::pow(adaptation, m)) / at_white;
          EXPECT_NEAR(got[c], std::min(want, 1.0), 1e-5)
              << contrast << ' ' << light << ' ' << chromatic;
        }
      }
    }
  }
}

// Light of one luminance has no range, and the least contrast that is chosen automatically.
TEST(ToneMapping, EvenLightHasTheLeastContrast) {
  LuminanceStatistics s = statistics(1);
  s.minimum_log = s.maximum_log = std::log(0.3);
  ToneOptions options;
  options.op = ToneOperator::reinhard_devlin;
  const ToneMapping automatic = *make_tone_mapping(options, s);
  options.contrast = 0.3;
  const ToneMapping least = *make_tone_mapping(options, s);
  for (const float light : {0.01f, 0.3f, 2.0f}) {
    const Vec3f a = automatic.map({light, light, light}), b = least.map({light, light, light});
    EXPECT_GT(a.x, 0);
    EXPECT_NEAR(a.x, b.x, 1e-6);
  }
}

TEST(ToneMapping, DoesNotDependOnTheUnitOfLuminance) {
  for (const ToneOperator op : kAll) {
    const ToneMapping one = mapping(op, 1);
    for (const double scale : {1e-6, 683.0, 1e9}) {
      const ToneMapping other = mapping(op, scale);
      for (const Vec3f c : {Vec3f{0.1f, 0.2f, 0.05f}, Vec3f{3, 1, 2}, Vec3f{8, 0, 0}}) {
        const auto s = static_cast<float>(scale);
        const Vec3f a = one.display(c), b = other.display({s * c.x, s * c.y, s * c.z});
        EXPECT_NEAR(a.x, b.x, 1e-4) << tone_operator_name(op) << ' ' << scale;
        EXPECT_NEAR(a.y, b.y, 1e-4);
        EXPECT_NEAR(a.z, b.z, 1e-4);
      }
    }
  }
}

TEST(ToneMapping, KeepsTheRatiosOfChannelsWhereItSaysSo) {
  for (const ToneOperator op :
       {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago}) {
    const Vec3f d = mapping(op, 1).map({0.4f, 0.2f, 0.1f});
    EXPECT_NEAR(d.x / d.y, 2, 1e-4) << tone_operator_name(op);
    EXPECT_NEAR(d.y / d.z, 2, 1e-4);
  }
}

TEST(ToneMapping, EndsWellOnExtremesAndWhatIsNoNumber) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const ToneOperator op : kAll)
    for (const double scale : {1e-20, 1e-6, 1.0, 1e9, 1e20}) {
      const ToneMapping tone = mapping(op, scale);
      for (const float v : {0.0f, 1e-38f, 1e-6f, 1.0f, 1e9f, 3e38f, inf, -1.0f, -inf, nan}) {
        for (const Vec3f c : {Vec3f{v, v, v}, Vec3f{v, 0, 0}, Vec3f{1, v, 1}}) {
          const Vec3f d = tone.display(c);
          for (const float x : {d.x, d.y, d.z})
            EXPECT_TRUE(x >= 0 && x <= 1) << tone_operator_name(op) << ' ' << v << ' ' << x;
        }
      }
      EXPECT_EQ(tone.display({nan, nan, nan}), (Vec3f{0, 0, 0}));
      EXPECT_EQ(tone.display({-1, -2, -3}), (Vec3f{0, 0, 0}));
    }
}

TEST(ToneMapping, RisesOverAllThatAFloatHolds) {
  for (const ToneOperator op : kAll)
    for (const double scale : {1e-30, 1e-20, 1.0, 1e20, 1e30})
      for (const double stops : {-64.0, 0.0, 64.0}) {
        ToneOptions options;
        options.exposure_stops = stops;
        const ToneMapping tone = mapping(op, scale, options);
        const float largest = std::numeric_limits<float>::max();
        float last = 0;
        for (float v = 1e-38f; v < largest / 1.1f; v *= 1.1f) {
          const Vec3f d = tone.map({v, v, v});
          // The ratio of two rounded logarithms may fall by as much as rounding.
          ASSERT_GE(d.y + 1e-12f, 0.99999f * last)
              << tone_operator_name(op) << ' ' << scale << ' ' << stops << ' ' << v;
          last = d.y;
        }
        if (largest > 10 * scale * std::exp2(-stops)) {
          EXPECT_GE(tone.map({largest, largest, largest}).x, 0.999f)
              << tone_operator_name(op) << ' ' << scale << ' ' << stops;
        }
      }
}

TEST(ToneMapping, TakesAWhiteAndAnExposureOfTheUsers) {
  ToneOptions options;
  options.white = 4;
  for (const ToneOperator op : kAll)
    EXPECT_NEAR(mapping(op, 1, options).map({4, 4, 4}).x, 1, 1e-5) << tone_operator_name(op);
  options.exposure_stops = 1;
  EXPECT_NEAR(mapping(ToneOperator::linear, 1, options).map({1, 1, 1}).x, 0.5, 1e-6);
  options.exposure_stops = -2;
  EXPECT_NEAR(mapping(ToneOperator::linear, 1, options).map({4, 4, 4}).x, 0.25, 1e-6);
}

TEST(ToneMapping, ShowsAnUnlitSceneBlack) {
  for (const ToneOperator op : kAll) {
    ToneOptions options;
    options.op = op;
    const auto tone = make_tone_mapping(options, LuminanceStatistics{});
    ASSERT_TRUE(tone.ok());
    EXPECT_EQ(tone->display({0, 0, 0}), (Vec3f{0, 0, 0}));
    EXPECT_GT(tone->display({1, 1, 1}).x, 0);
  }
}

// The scale of such light is infinite as a float, which would show all of it white.
TEST(ToneMapping, RefusesLightWhoseScaleFloatsDoNotHold) {
  for (const ToneOperator op : kAll) {
    ToneOptions options;
    options.op = op;
    const auto weak = make_tone_mapping(options, statistics(1e-42));
    ASSERT_FALSE(weak.ok()) << tone_operator_name(op);
    EXPECT_EQ(weak.status().code(), ErrorCode::bad_input);
    EXPECT_NE(weak.status().message().find("another unit"), std::string::npos);
    EXPECT_TRUE(make_tone_mapping(options, statistics(1e-36)).ok());
  }
}

TEST(ToneMapping, RefusesOptionsOutOfRange) {
  const auto refused = [](auto change) {
    ToneOptions o;
    change(o);
    const auto r = make_tone_mapping(o, statistics(1));
    return !r.ok() && r.status().code() == ErrorCode::bad_option &&
           r.status().message().find("must be") != std::string::npos;
  };
  EXPECT_TRUE(refused([](ToneOptions& o) { o.white = -1; }));
  EXPECT_TRUE(refused([](ToneOptions& o) { o.white = std::nan(""); }));
  EXPECT_TRUE(refused([](ToneOptions& o) { o.bias = 0.2; }));
  EXPECT_TRUE(refused([](ToneOptions& o) { o.key = 0; }));
  EXPECT_TRUE(refused([](ToneOptions& o) { o.contrast = 9; }));
  EXPECT_TRUE(refused([](ToneOptions& o) { o.exposure_stops = 1e6; }));
  EXPECT_TRUE(refused([](ToneOptions& o) { o.chromatic_adaptation = 2; }));
  EXPECT_TRUE(refused([](ToneOptions& o) { o.light_adaptation = -0.1; }));
}

TEST(ToneOperators, AreFoundByName) {
  for (const ToneOperator op : kAll) {
    const auto found = parse_tone_operator(tone_operator_name(op));
    ASSERT_TRUE(found.ok());
    EXPECT_EQ(*found, op);
  }
  const auto wrong = parse_tone_operator("filmic");
  ASSERT_FALSE(wrong.ok());
  EXPECT_NE(wrong.status().message().find("reinhard-devlin"), std::string::npos);
}

TEST(Lanes, EncodeLikeTheScalarFunction) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 200000; ++i) {
    const float x = std::pow(static_cast<float>(i) / 190000, 3.0f);
    const Lanes d = srgb_encode_lanes(Lanes{x, -x, 1 - x, 7});
    ASSERT_EQ(d[0], srgb_encode(x));
    ASSERT_EQ(d[1], 0);
    ASSERT_EQ(d[2], srgb_encode(1 - x));
    ASSERT_EQ(d[3], 1);
  }
  EXPECT_EQ(srgb_encode_lanes(splat_lanes(nan))[0], 0);
}

}  // namespace
}  // namespace atlas
