#include "libatlas/charts/relative_density.h"

#include <algorithm>
#include <cmath>

namespace atlas {

RelativeDensity relative_density(std::span<const float> density) {
  constexpr int kWidestRange = 250;  // half of it is less than the exponents of normal floats
  RelativeDensity relative;
  relative.values.assign(density.begin(), density.end());
  if (density.empty()) return relative;
  const auto [least, most] = std::minmax_element(density.begin(), density.end());
  const int low = std::ilogb(*least), high = std::ilogb(*most);
  const int middle = (low + high) >> 1;  // rounded down, also below 0
  if (middle == 0 || high - low > kWidestRange) return relative;
  relative.factor = std::ldexp(1.0, middle);
  for (float& d : relative.values) d = std::ldexp(d, -middle);
  return relative;
}

}  // namespace atlas
