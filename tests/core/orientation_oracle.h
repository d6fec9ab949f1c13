// Compares orientation() with CGAL's exact predicates.
#pragma once

#include <cstdint>

namespace atlas::test {

struct OrientationCount {
  std::int64_t different = 0, collinear = 0;
};

// Compares `count` triples: random bits (all exponents), and points on or next to a line, as they
// are, on a grid, and scaled by powers of two down to denormal and up to the largest numbers.
OrientationCount compare_orientations(std::int64_t count, std::uint64_t seed);

}  // namespace atlas::test
