// Internal: elementary functions that return the same bits with every C library and processor.
// Libraries round the last place differently, and one such bit decides near ties: where charts are
// cut, which layout is kept. Only operations that IEEE 754 defines to the bit are used (+ - * / and
// square roots), without contraction. tests/core/portable_math_test.cpp gives the errors.
#pragma once

namespace atlas::portable {

// Within 1 unit in the last place for |x| up to 2^20. Larger angles are first reduced by the double
// next to 2 pi. Not a number for infinities.
double sin(double x);
double cos(double x);

// Within 1 unit in the last place, with the signs and special values of the C standard.
double atan2(double y, double x);

// Within 2 units in the last place; not a number outside -1..1.
double acos(double x);

// Within 1 unit in the last place; exp() of less than -708 is rounded once more.
double exp(double x);
double log(double x);
double log2(double x);  // exact for powers of two

// x >= 0. Within 2 units in the last place for |y| up to 64.
double pow(double x, double y);

// Within 1 unit in the last place; does not overflow or underflow on the way.
double hypot(double x, double y);

}  // namespace atlas::portable
