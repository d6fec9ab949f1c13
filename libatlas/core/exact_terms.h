// Internal: sums and products of two doubles without rounding.
#pragma once

namespace atlas {

// The rounded value, and what rounding took from it.
struct Exact {
  double high, low;
};

// The rounding errors of sums, differences and products are doubles themselves, which a few more
// operations find (Shewchuk 1997, sections 2.2 and 2.5).
inline Exact exact_sum(double a, double b) {
  const double sum = a + b, b_part = sum - a, a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

inline Exact exact_difference(double a, double b) {
  return exact_sum(a, -b);
}

// Returns the upper 26 bits of a number, and the rest. |a| is below 2^996.
inline Exact halves(double a) {
  const double shifted = 0x1.0000002p27 * a, high = shifted - (shifted - a);
  return {high, a - high};
}

// The product must be a finite number, and 0 or at least 2^-968.
inline Exact exact_product(double a, double b) {
  const double product = a * b;
  const Exact p = halves(a), q = halves(b);
  const double rest = p.high * q.high - product + p.high * q.low + p.low * q.high;
  return {product, rest + p.low * q.low};
}

}  // namespace atlas
