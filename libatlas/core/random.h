// Internal: random numbers that are the same with every standard library, unlike those of the
// standard distributions.
#pragma once

#include <random>

namespace atlas {

// Returns a number in [0, 1), uniform over all multiples of 2^-53.
inline double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace atlas
