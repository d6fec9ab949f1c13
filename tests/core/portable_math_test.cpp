// Compares portable_math.h with the C library in long double, which has eleven more bits on x86.
#include "libatlas/core/portable_math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "libatlas/core/random.h"

namespace atlas {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kCount = 100000;

// Returns the error in units in the last place of the exact value.
double error(double value, long double exact) {
  const auto rounded = double(exact);
  if (std::isinf(rounded)) return value == rounded ? 0 : kInfinity;
  const double place = std::abs(rounded) < std::numeric_limits<double>::min()
                           ? std::numeric_limits<double>::denorm_min()
                           : std::ldexp(1, std::ilogb(rounded) - 52);
  return double(std::abs(value - exact) / place);
}

// Returns the largest error over arguments that `argument(i)` gives.
template <class Function, class Exact, class Argument>
double worst(const Function& function, const Exact& exact, const Argument& argument) {
  double most = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = argument(i);
    most = std::max(most, error(function(x), exact(static_cast<long double>(x))));
  }
  return most;
}

template <class Function, class Exact, class Arguments>
double worst_of_two(const Function& function, const Exact& exact, const Arguments& arguments) {
  double most = 0;
  for (int i = 0; i < kCount; ++i) {
    const auto [x, y] = arguments(i);
    most = std::max(most, error(function(x, y),
                                exact(static_cast<long double>(x), static_cast<long double>(y))));
  }
  return most;
}

using Wide = long double;

TEST(PortableMath, SineAndCosine) {
  if (std::numeric_limits<Wide>::digits < 64) GTEST_SKIP() << "long double is double here";
  Random random(1);
  // Angles of all sizes, and some next to multiples of a quarter turn.
  const auto angle = [&](int i) {
    if (i % 4 == 0) return 20 * random.unit() - 10;
    if (i % 4 == 1) return 0x1p21 * random.unit() - 0x1p20;
    if (i % 4 == 2) return std::ldexp(random.unit(), -int(random.below(60)));
    return std::nextafter(random.below(4000) * std::numbers::pi / 2, 0.0);
  };
  EXPECT_LE(worst(
                portable::sin, [](Wide x) { return std::sin(x); }, angle),
            1);
  EXPECT_LE(worst(
                portable::cos, [](Wide x) { return std::cos(x); }, angle),
            1);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(portable::sin(-0.0)), std::uint64_t{1} << 63);
  EXPECT_EQ(portable::cos(0.0), 1);
  EXPECT_TRUE(std::isnan(portable::sin(kInfinity)));
  EXPECT_LE(std::abs(portable::sin(1e300)), 1);
}

TEST(PortableMath, ArcTangentAndArcCosine) {
  if (std::numeric_limits<Wide>::digits < 64) GTEST_SKIP() << "long double is double here";
  Random random(2);
  const auto sign = [&] { return random.below(2) == 0 ? 1.0 : -1.0; };
  const auto both = [&](int i) {
    if (i % 2 == 0) return std::pair(sign() * random.unit(), sign() * random.unit());
    const auto any = [&] {
      return sign() * std::ldexp(1 + random.unit(), int(random.below(1900)) - 950);
    };
    return std::pair(any(), any());
  };
  EXPECT_LE(worst_of_two(
                portable::atan2, [](Wide y, Wide x) { return std::atan2(y, x); }, both),
            1);
  const auto cosine = [&](int i) {
    return i % 2 == 0 ? 2 * random.unit() - 1
                      : sign() * (1 - std::ldexp(random.unit(), -int(random.below(54))));
  };
  EXPECT_LE(worst(
                portable::acos, [](Wide x) { return std::acos(x); }, cosine),
            2);
  EXPECT_TRUE(std::isnan(portable::acos(1 + 0x1p-52)));
  for (const double y : {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity})
    for (const double x : {0.0, -0.0, 1.0, -1.0, kInfinity, -kInfinity}) {
      const double own = portable::atan2(y, x), theirs = std::atan2(y, x);
      EXPECT_EQ(std::bit_cast<std::uint64_t>(own), std::bit_cast<std::uint64_t>(theirs))
          << y << " " << x;
    }
}

TEST(PortableMath, Logarithms) {
  if (std::numeric_limits<Wide>::digits < 64) GTEST_SKIP() << "long double is double here";
  Random random(3);
  const auto positive = [&](int i) {
    if (i % 2 == 0) return std::ldexp(1 + random.unit(), int(random.below(2096)) - 1074);
    return 1 + std::ldexp(random.unit() - 0.5, -int(random.below(53)));
  };
  EXPECT_LE(worst(
                portable::log, [](Wide x) { return std::log(x); }, positive),
            1);
  EXPECT_LE(worst(
                portable::log2, [](Wide x) { return std::log2(x); }, positive),
            1);
  for (int i = -1074; i < 1024; ++i) EXPECT_EQ(portable::log2(std::ldexp(1, i)), i);
  EXPECT_EQ(portable::log(0), -kInfinity);
  EXPECT_EQ(portable::log(kInfinity), kInfinity);
  EXPECT_EQ(portable::log(1), 0);
  EXPECT_TRUE(std::isnan(portable::log(-1)));
}

TEST(PortableMath, Powers) {
  if (std::numeric_limits<Wide>::digits < 64) GTEST_SKIP() << "long double is double here";
  Random random(4);
  const auto exponent = [&](int i) {
    return i % 2 == 0 ? 1416 * random.unit() - 708
                      : std::ldexp(random.unit() - 0.5, -int(random.below(60)));
  };
  EXPECT_LE(worst(
                portable::exp, [](Wide x) { return std::exp(x); }, exponent),
            1);
  EXPECT_EQ(portable::exp(0), 1);
  EXPECT_EQ(portable::exp(800), kInfinity);
  EXPECT_EQ(portable::exp(-800), 0);
  EXPECT_TRUE(std::isnan(portable::exp(std::numeric_limits<double>::quiet_NaN())));
  const auto both = [&](int i) {
    const double y = 128 * random.unit() - 64;
    return std::pair(i % 2 == 0 ? 4 * random.unit() : std::ldexp(1, int(random.below(30)) - 15), y);
  };
  EXPECT_LE(worst_of_two(
                portable::pow, [](Wide x, Wide y) { return std::pow(x, y); }, both),
            2);
  for (const double x : {0.0, 0.5, 1.0, 2.0, kInfinity})
    for (const double y : {0.0, 1.0, -1.0, 1e300, -1e300})
      EXPECT_EQ(portable::pow(x, y), std::pow(x, y)) << x << " " << y;
}

TEST(PortableMath, Hypotenuse) {
  if (std::numeric_limits<Wide>::digits < 64) GTEST_SKIP() << "long double is double here";
  Random random(5);
  const auto both = [&](int i) {
    const int size = int(random.below(2000)) - 1000;
    const int other = i % 2 == 0 ? size : std::max(-1000, size - int(random.below(60)));
    return std::pair(std::ldexp(1 + random.unit(), size), -std::ldexp(1 + random.unit(), other));
  };
  EXPECT_LE(worst_of_two(
                portable::hypot, [](Wide x, Wide y) { return std::hypot(x, y); }, both),
            1);
  EXPECT_EQ(portable::hypot(3, -4), 5);
  EXPECT_EQ(portable::hypot(0, 0), 0);
  EXPECT_EQ(portable::hypot(-kInfinity, 1), kInfinity);
}

}  // namespace
}  // namespace atlas
