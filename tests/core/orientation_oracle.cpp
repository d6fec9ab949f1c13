#include "tests/core/orientation_oracle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <array>
#include <bit>
#include <cmath>

#include "libatlas/core/predicates.h"
#include "libatlas/core/random.h"

namespace atlas::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Coordinates = std::array<double, 6>;  // of a, b and c

double finite(Random& random) {
  for (;;) {
    const double x = std::bit_cast<double>(random.next());
    if (std::isfinite(x)) return x;
  }
}

Coordinates random_bits(Random& random) {
  Coordinates p;
  for (double& x : p) x = finite(random);
  if (random.below(2) == 0) p[4] = p[0];
  return p;
}

// Returns three points that are collinear before rounding.
Coordinates along_a_line(Random& random) {
  const auto coordinate = [&] { return 2 * random.unit() - 1; };
  Coordinates p{coordinate(), coordinate(), coordinate(), coordinate(), 0, 0};
  const double t = 2 * coordinate();
  p[4] = p[0] + t * (p[2] - p[0]);
  p[5] = p[1] + t * (p[3] - p[1]);
  return p;
}

void scale(Coordinates& p, Random& random) {
  const double factor = std::ldexp(1, int(random.below(2090)) - 1074);
  for (double& x : p) x *= factor;
}

Coordinates triple(std::int64_t i, Random& random) {
  if (i % 5 == 0) return random_bits(random);
  Coordinates p = along_a_line(random);
  if (i % 5 == 1) return p;
  if (i % 5 == 2) {  // some units in the last place beside the line
    double& x = p[random.below(6)];
    x = std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) ^ random.below(4));
    return p;
  }
  if (i % 5 == 3) {
    for (double& x : p) x = std::floor(8 * x);
  }
  scale(p, random);
  return p;
}

}  // namespace

OrientationCount compare_orientations(std::int64_t count, std::uint64_t seed) {
  Random random(seed);
  OrientationCount result;
  for (std::int64_t i = 0; i < count; ++i) {
    const Coordinates p = triple(i, random);
    const int exact = CGAL::orientation(Kernel::Point_2(p[0], p[1]), Kernel::Point_2(p[2], p[3]),
                                        Kernel::Point_2(p[4], p[5]));
    result.collinear += exact == 0;
    result.different += orientation({p[0], p[1]}, {p[2], p[3]}, {p[4], p[5]}) != exact;
  }
  return result;
}

}  // namespace atlas::test
