#include "libatlas/core/predicates.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "libatlas/core/exact_terms.h"

namespace atlas {
namespace {

int sign_of(double x) {
  return (x > 0) - (x < 0);
}

// A sum of doubles, kept as terms that do not overlap, in the order of their size (Shewchuk 1997,
// section 2.3). The sign is therefore that of the last term that is not 0.
class Expansion {
 public:
  void add(double x) {
    for (std::size_t i = 0; i < count_; ++i) {
      const Exact sum = exact_sum(x, terms_[i]);
      terms_[i] = sum.low;
      x = sum.high;
    }
    terms_[count_++] = x;
  }
  void add_product(double a, double b) {
    const Exact product = exact_product(a, b);
    add(product.low);
    add(product.high);
  }
  int sign() const {
    for (std::size_t i = count_; i-- > 0;)
      if (terms_[i] != 0) return sign_of(terms_[i]);
    return 0;
  }

 private:
  std::array<double, 16> terms_;
  std::size_t count_ = 0;
};

// Expansions are used where the largest coordinate is at most kLargest and the smallest but 0 at
// least kSmallest. Differences are then multiples of 2^-452, and the errors of their products
// multiples of 2^-904: nothing underflows. Products stay below 2^1002.
constexpr double kSmallest = 0x1p-400, kLargest = 0x1p500;

bool within_range(std::array<double, 6> coordinates) {
  return std::all_of(coordinates.begin(), coordinates.end(), [](double x) {
    x = std::abs(x);
    return x == 0 || (x >= kSmallest && x <= kLargest);
  });
}

// Determines the sign by products of differences, where each difference is a rounded value and an
// error. First the errors are taken to be 0, which they mostly are, then all terms are summed up.
int sign_by_expansions(Vec2d a, Vec2d b, Vec2d c) {
  const Exact bx = exact_difference(b.x, a.x), by = exact_difference(b.y, a.y);
  const Exact cx = exact_difference(c.x, a.x), cy = exact_difference(c.y, a.y);
  Expansion sum;
  sum.add_product(bx.high, cy.high);
  sum.add_product(-by.high, cx.high);
  if (bx.low == 0 && by.low == 0 && cx.low == 0 && cy.low == 0) return sum.sign();
  for (const auto& [p, q] :
       {std::pair{bx.high, cy.low}, std::pair{bx.low, cy.high}, std::pair{bx.low, cy.low},
        std::pair{-by.high, cx.low}, std::pair{-by.low, cx.high}, std::pair{-by.low, cx.low}})
    sum.add_product(p, q);
  return sum.sign();
}

// A sum of products of doubles in fixed point, wide enough for all of these. Digits have 32 bits,
// and are not carried before the end.
class LongSum {
 public:
  void add_product(double a, double b) {
    const Parts p = parts_of(a), q = parts_of(b);
    const bool negative = p.negative != q.negative;
    // The product of two mantissas, as four digits.
    const std::uint64_t low = (p.mantissa & kMask) * (q.mantissa & kMask),
                        mixed = (p.mantissa >> 32) * (q.mantissa & kMask),
                        other = (p.mantissa & kMask) * (q.mantissa >> 32),
                        high = (p.mantissa >> 32) * (q.mantissa >> 32);
    const std::size_t shift = p.shift + q.shift;
    for (const auto& [value, at] : {std::pair{low, shift}, std::pair{mixed, shift + 32},
                                    std::pair{other, shift + 32}, std::pair{high, shift + 64}})
      add(value, at, negative);
  }

  int sign() {
    std::int64_t carry = 0;
    bool any = false;
    for (std::int64_t& digit : digits_) {
      const std::int64_t sum = digit + carry;
      carry = sum >> 32;
      digit = sum & std::int64_t(kMask);
      any = any || digit != 0;
    }
    return carry < 0 ? -1 : any ? 1 : 0;
  }

 private:
  static constexpr std::uint64_t kMask = 0xffffffff;
  struct Parts {
    bool negative;
    std::uint64_t mantissa;
    std::size_t shift;  // the number is mantissa * 2^(shift - 1074)
  };

  static Parts parts_of(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
    const auto exponent = std::size_t(bits >> 52 & 0x7ff);
    if (exponent == 0) return {bits >> 63 != 0, fraction, 0};
    return {bits >> 63 != 0, fraction | std::uint64_t{1} << 52, exponent - 1};
  }

  // Adds value * 2^bit.
  void add(std::uint64_t value, std::size_t bit, bool negative) {
    const std::size_t digit = bit / 32, shift = bit % 32;
    const std::uint64_t low = (value & kMask) << shift, high = (value >> 32) << shift;
    const std::array<std::uint64_t, 3> parts{low & kMask, (low >> 32) + (high & kMask), high >> 32};
    for (std::size_t i = 0; i < parts.size(); ++i)
      digits_[digit + i] += negative ? -std::int64_t(parts[i]) : std::int64_t(parts[i]);
  }

  // 2 * 2046 bits of shift, 106 of the product, and room for the sum.
  std::array<std::int64_t, (2 * 2046 + 106 + 64) / 32 + 1> digits_{};
};

int sign_by_long_sum(Vec2d a, Vec2d b, Vec2d c) {
  LongSum sum;
  sum.add_product(a.x, b.y);
  sum.add_product(-a.y, b.x);
  sum.add_product(b.x, c.y);
  sum.add_product(-b.y, c.x);
  sum.add_product(c.x, a.y);
  sum.add_product(-c.y, a.x);
  return sum.sign();
}

// Returns whether p lies strictly between a and b. The three must be collinear.
bool strictly_between(Vec2d a, Vec2d b, Vec2d p) {
  if (a.x != b.x) return std::min(a.x, b.x) < p.x && p.x < std::max(a.x, b.x);
  return std::min(a.y, b.y) < p.y && p.y < std::max(a.y, b.y);
}

// Returns whether the segments ab and bc, neighbours on a border, overlap along a stretch.
bool fold_back(Vec2d a, Vec2d b, Vec2d c) {
  if (orientation(a, b, c) != 0) return false;
  return strictly_between(a, b, c) || strictly_between(b, c, a) || (a == c && !(a == b));
}

}  // namespace

int close_orientation(Vec2d a, Vec2d b, Vec2d c) {
  // Neighbouring edges share a point, and if two of the three points are equal, the bound in
  // orientation() never decides.
  if (a == b || b == c || a == c) return 0;
  return within_range({a.x, a.y, b.x, b.y, c.x, c.y}) ? sign_by_expansions(a, b, c)
                                                      : sign_by_long_sum(a, b, c);
}

bool near_segments_cross(Vec2d a, Vec2d b, Vec2d c, Vec2d d) {
  if (b == c) return fold_back(a, b, d);
  if (a == d) return fold_back(c, a, b);
  if (a == c) return fold_back(b, a, d);
  if (b == d) return fold_back(a, b, c);
  const int c_side = orientation(a, b, c), d_side = orientation(a, b, d);
  const int a_side = orientation(c, d, a), b_side = orientation(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  if (c_side == 0 && strictly_between(a, b, c)) return true;
  if (d_side == 0 && strictly_between(a, b, d)) return true;
  if (a_side == 0 && strictly_between(c, d, a)) return true;
  return b_side == 0 && strictly_between(c, d, b);
}

}  // namespace atlas
