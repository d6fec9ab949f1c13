#include "libatlas/core/portable_math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "libatlas/core/exact_terms.h"

namespace atlas::portable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

// Constants that one double does not hold: the double next to it, and the rest.
constexpr Exact kPi{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53},
    kHalfPi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},
    kOneByLn2{0x1.71547652b82fep+0, 0x1.777d0ffda0d24p-56};
// Here, the upper part has 33 bits, so that multiples of it are exact.
constexpr Exact kLn2{0x1.62e42fefp-1, 0x1.473de6af278edp-34};
// pi / 2, likewise.
constexpr std::array<double, 4> kHalfPiParts{0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2ep-69,
                                             0x1.b839a252049c1p-104};

// Returns c[0] + x (c[1] + x (c[2] + ...)).
double polynomial(std::span<const double> c, double x) {
  double sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = c[i] + x * sum;
  return sum;
}

template <std::size_t N, class Term>
constexpr std::array<double, N> series(const Term& term) {
  std::array<double, N> terms{};
  for (std::size_t i = 0; i < N; ++i) terms[i] = term(int(i));
  return terms;
}

constexpr double factorial(int n) {
  double product = 1;  // exact up to 18!
  for (int i = 2; i <= n; ++i) product *= i;
  return product;
}

constexpr double alternating(int i) {
  return i % 2 == 0 ? 1 : -1;
}

// The Taylor series, from the first term that is not computed apart on.
constexpr auto kSine = series<8>([](int i) { return -alternating(i) / factorial(2 * i + 3); });
constexpr auto kCosine = series<7>([](int i) { return alternating(i) / factorial(2 * i + 4); });
constexpr auto kArcTangent = series<8>([](int i) { return -alternating(i) / (2 * i + 3); });
constexpr auto kLogarithm = series<11>([](int i) { return 2.0 / (2 * i + 3); });
constexpr auto kExponential = series<13>([](int i) { return 1 / factorial(i + 2); });

struct Reduced {
  std::int64_t quarter;  // how many quarter turns were taken away
  Exact angle;           // what is left, within pi / 4
};

Reduced reduced(double x) {
  if (std::abs(x) > 0x1p20) x = std::fmod(x, 2 * kPi.high);
  const double turns = std::floor(x * (2 / kPi.high) + 0.5);
  const auto& part = kHalfPiParts;
  const Exact first = exact_difference(x - turns * part[0], turns * part[1]);
  const Exact second = exact_difference(first.high, turns * part[2]);
  const double rest = first.low + second.low - turns * part[3];
  return {std::int64_t(turns), exact_sum(second.high, rest)};
}

double sine_near_0(Exact x) {
  const double square = x.high * x.high;
  const double rest = x.high * square * polynomial(kSine, square) - 0.5 * x.low * square;
  return x.high + (x.low + rest);
}

double cosine_near_0(Exact x) {
  const double square = x.high * x.high;
  const Exact sum = exact_difference(1, 0.5 * square);
  return sum.high + (sum.low + (square * square * polynomial(kCosine, square) - x.high * x.low));
}

// Returns sin(x + quarters * pi / 2).
double sine(double x, int quarters) {
  if (!std::isfinite(x)) return kNotANumber;
  const Reduced r = reduced(x);
  const std::int64_t quarter = (r.quarter + quarters) & 3;
  const double value = quarter % 2 == 0 ? sine_near_0(r.angle) : cosine_near_0(r.angle);
  return quarter < 2 ? value : -value;
}

// The arc tangents of multiples of an eighth.
constexpr std::array<Exact, 9> kAtans{Exact{0, 0},
                                      Exact{0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                      Exact{0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                      Exact{0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                      Exact{0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                      Exact{0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                      Exact{0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                      Exact{0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                      Exact{0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};

// Returns atan(low / high) for 0 <= low <= high.
Exact arc_tangent(double low, double high) {
  const double eighths = std::floor(8 * (low / high) + 0.5), c = eighths / 8;
  const Exact& near = kAtans[std::size_t(eighths)];
  const Exact product = exact_product(c, high);
  const double t = (low - product.high - product.low) / (high + c * low);
  const Exact sum = exact_sum(near.high, t);
  return {sum.high, sum.low + (t * (t * t) * polynomial(kArcTangent, t * t) + near.low)};
}

Exact difference(Exact a, Exact b) {
  const Exact high = exact_difference(a.high, b.high);
  return {high.high, high.low + (a.low - b.low)};
}

// Returns log(m) for the m within 2^-0.5 and 2^0.5 that x is times 2^exponent. The area tangent
// turns log(1 + f) into a series of odd powers of f / (2 + f).
struct Logarithm {
  Exact mantissa;
  double exponent;
};

Logarithm logarithm(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0x1.6a09e667f3bcdp-1) {
    m *= 2;
    --exponent;
  }
  const double f = m - 1;
  const Exact below = exact_sum(2, f);
  const double s = f / below.high;
  const Exact product = exact_product(s, below.high);
  const double rest = (f - product.high - product.low - s * below.low) / below.high;
  const double square = s * s;
  return {exact_sum(2 * s, 2 * rest + s * square * polynomial(kLogarithm, square)),
          double(exponent)};
}

Exact natural(const Logarithm& log) {
  const Exact sum = exact_sum(log.exponent * kLn2.high, log.mantissa.high);
  return exact_sum(sum.high, sum.low + (log.exponent * kLn2.low + log.mantissa.low));
}

// Returns the logarithm of what has none, or an infinite one.
double no_logarithm(double x) {
  if (x == 0) return -kInfinity;
  return x > 0 ? x : kNotANumber;
}

bool has_logarithm(double x) {
  return x > 0 && x < kInfinity;
}

double exponential(Exact x) {
  if (x.high > 710) return kInfinity;
  if (x.high < -746) return 0;
  const double power = std::floor(x.high * kOneByLn2.high + 0.5);
  const Exact r = exact_sum(x.high - power * kLn2.high, x.low - power * kLn2.low);
  const double rest = r.low + r.high * r.high * polynomial(kExponential, r.high);
  const Exact sum = exact_sum(1, r.high);
  return std::ldexp(sum.high + (sum.low + rest), int(power));
}

}  // namespace

double sin(double x) {
  return x == 0 ? x : sine(x, 0);
}

double cos(double x) {
  return sine(x, 1);
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNotANumber;
  double low = std::abs(y), high = std::abs(x);
  if (low == kInfinity && high == kInfinity) low = high = 1;
  const bool steep = low > high;
  if (steep) std::swap(low, high);
  Exact angle{0, 0};
  if (high == kInfinity) {
    low = 0;
  } else if (high > 0x1p900 || high < 0x1p-900) {
    const double scale = high > 1 ? 0x1p-200 : 0x1p120;
    low *= scale;
    high *= scale;
  }
  if (low > 0) angle = low < 0x1p-60 * high ? Exact{low / high, 0} : arc_tangent(low, high);
  if (steep) angle = difference(kHalfPi, angle);
  if (std::signbit(x)) angle = difference(kPi, angle);
  return std::copysign(angle.high + angle.low, y);
}

double acos(double x) {
  if (!(std::abs(x) <= 1)) return kNotANumber;
  return atan2(std::sqrt((1 - x) * (1 + x)), x);
}

double exp(double x) {
  return std::isnan(x) ? x : exponential({x, 0});
}

double log(double x) {
  if (!has_logarithm(x)) return no_logarithm(x);
  const Exact log = natural(logarithm(x));
  return log.high + log.low;
}

double log2(double x) {
  if (!has_logarithm(x)) return no_logarithm(x);
  const Logarithm log = logarithm(x);
  const Exact product = exact_product(log.mantissa.high, kOneByLn2.high);
  const double rest =
      product.low + (log.mantissa.high * kOneByLn2.low + log.mantissa.low * kOneByLn2.high);
  const Exact sum = exact_sum(log.exponent, product.high);
  return sum.high + (sum.low + rest);
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (!has_logarithm(x) || !std::isfinite(y)) {
    if (std::isnan(x) || std::isnan(y) || x < 0) return kNotANumber;
    return (x > 1) == (y > 0) ? kInfinity : 0;
  }
  const Exact log = natural(logarithm(x));
  if (!(std::abs(y * log.high) < 800)) return (y > 0) == (log.high > 0) ? kInfinity : 0;
  Exact product = exact_product(y, log.high);
  product.low += y * log.low;
  return exponential(product);
}

double hypot(double x, double y) {
  x = std::abs(x);
  y = std::abs(y);
  if (x == kInfinity || y == kInfinity) return kInfinity;
  if (x < y) std::swap(x, y);
  double scale = 1;
  if (x > 0x1p500) scale = 0x1p-600;
  if (x < 0x1p-450) scale = 0x1p600;
  x *= scale;
  y *= scale;
  const Exact p = exact_product(x, x), q = exact_product(y, y);
  const Exact sum = exact_sum(p.high, q.high);
  return std::sqrt(sum.high + (sum.low + (p.low + q.low))) / scale;
}

}  // namespace atlas::portable
