// Internal: reads numbers from text, independent of the locale.
#pragma once

#include <cstdint>

namespace atlas {

// Reads a decimal number, "nan", "inf", or what Microsoft's runtime wrote for these ("1.#IND"), at
// `at`; the text must continue to a non-digit at or before `end`. Numbers beyond the range of
// double become infinite or 0. Returns where the number ends, or null if there is none. Unlike
// std::from_chars, it accepts a leading '+' and returns a value for numbers out of range.
const char* parse_number_slow(const char* at, const char* end, double& value);

// The same, but fast for common numbers: an integer of up to 15 digits and a power of ten up to
// 10^22 are both exact doubles, so one division of them rounds correctly (Clinger 1990). All other
// numbers go to parse_number_slow().
inline const char* parse_number(const char* at, const char* end, double& value) {
  constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* p = at;
  const bool negative = *p == '-';
  if (*p == '-' || *p == '+') ++p;
  std::uint64_t mantissa = 0;
  int digits = 0, exponent = 0;
  for (; *p >= '0' && *p <= '9'; ++p, ++digits) mantissa = mantissa * 10 + std::uint64_t(*p - '0');
  if (*p == '.') {
    const char* point = ++p;
    for (; *p >= '0' && *p <= '9'; ++p, ++digits) {
      mantissa = mantissa * 10 + std::uint64_t(*p - '0');
    }
    exponent = -int(p - point);
  }
  if (digits == 0 || digits > 15 || *p == 'e' || *p == 'E' || *p == '#' || exponent < -22) {
    return parse_number_slow(at, end, value);
  }
  const double magnitude = double(mantissa) / kPowers[-exponent];
  value = negative ? -magnitude : magnitude;
  return p;
}

}  // namespace atlas
