#include "libatlas/core/srgb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atlas {
namespace {

// The definition of IEC 61966-2-1.
double encode(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}

TEST(Srgb, EncodesWithinTwoMillionthsOfTheDefinition) {
  double worst = 0;
  for (int i = 0; i <= 2000000; ++i) {
    const float x = std::pow(static_cast<float>(i) / 2000000, 2.0f);
    worst = std::max(worst, std::fabs(srgb_encode(x) - encode(x)));
  }
  EXPECT_LT(worst, 2e-6);
}

TEST(Srgb, QuantisesExactly) {
  for (int i = 0; i <= 2000000; ++i) {
    const float x = std::pow(static_cast<float>(i) / 2000000, 2.0f);
    ASSERT_EQ(srgb_encode8(x), static_cast<int>(std::floor(encode(x) * 255 + 0.5))) << x;
  }
  // Tests every float around each bound between two codes.
  for (int code = 1; code < 256; ++code) {
    const double d = (code - 0.5) / 255;
    float x = static_cast<float>(d <= 0.04045 ? d / 12.92 : std::pow((d + 0.055) / 1.055, 2.4));
    for (int k = 0; k < 4; ++k) x = std::nextafter(x, 0.0f);
    for (int k = 0; k < 9; ++k, x = std::nextafter(x, 2.0f)) {
      const double scaled = encode(x) * 255 + 0.5;
      if (std::fabs(scaled - code) < 1e-9) continue;  // within double rounding of the bound
      ASSERT_EQ(srgb_encode8(x), static_cast<int>(std::floor(scaled))) << code;
    }
  }
}

TEST(Srgb, CodesSurviveDecodingAndEncoding) {
  for (int code = 0; code < 256; ++code) {
    const auto c = static_cast<std::uint8_t>(code);
    EXPECT_EQ(srgb_encode8(srgb_decode8(c)), code);
    EXPECT_NEAR(srgb_decode(code / 255.0f), srgb_decode8(c), 1e-6);
    EXPECT_EQ(quantize8(code / 255.0f), code);
  }
}

TEST(Srgb, ClampsWhatIsNoDisplayValue) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float low : {-1.0f, -inf, nan, -0.0f}) {
    EXPECT_EQ(srgb_encode(low), 0);
    EXPECT_EQ(srgb_encode8(low), 0);
    EXPECT_EQ(srgb_decode(low), 0);
    EXPECT_EQ(quantize8(low), 0);
  }
  for (const float high : {1.0f, 2.0f, inf, 3e38f}) {
    EXPECT_EQ(srgb_encode(high), 1);
    EXPECT_EQ(srgb_encode8(high), 255);
    EXPECT_EQ(srgb_decode(high), 1);
    EXPECT_EQ(quantize8(high), 255);
  }
}

}  // namespace
}  // namespace atlas
