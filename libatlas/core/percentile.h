// Internal: percentiles of values that all weigh the same.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace atlas {

// Returns the value below which the share `q`, in [0, 1], of all values lies; the largest value
// for 1. There is at least one value. Reorders the values.
template <class T>
T percentile(std::vector<T>& values, double q) {
  const auto rank = static_cast<std::size_t>(q * static_cast<double>(values.size()));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size() - 1, rank));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace atlas
