// Internal: random numbers that are the same with every standard library, whose distributions are
// not.
#pragma once

#include <random>

namespace atlas {

// In [0, 1), of all multiples of 2^-53 alike.
inline double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace atlas
