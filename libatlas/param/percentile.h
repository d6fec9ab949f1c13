// Internal: percentiles of weighted values in linear time.
#pragma once

#include <algorithm>
#include <vector>

namespace atlas::param {

struct WeightedValue {
  double value, weight;
};

// The smallest value that all but `share` of the weight does not exceed; 0 for none. Reorders
// values.
inline double upper_percentile(std::vector<WeightedValue>& values, double share) {
  if (values.empty()) return 0;
  double total = 0;
  for (const WeightedValue& v : values) total += v.weight;
  const double budget = share * total;
  const auto above = [](const WeightedValue& a, const WeightedValue& b) {
    return a.value != b.value ? a.value > b.value : a.weight > b.weight;
  };
  // Only the upper tail need be sorted; take a longer one until it holds the budget.
  for (std::size_t tail = values.size() / 256 + 16;; tail *= 4) {
    tail = std::min(tail, values.size());
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(tail);
    if (tail < values.size()) std::nth_element(values.begin(), end, values.end(), above);
    double weight = 0;
    for (auto v = values.begin(); v != end; ++v) weight += v->weight;
    if (weight <= budget && tail < values.size()) continue;
    std::sort(values.begin(), end, above);
    weight = 0;
    for (auto v = values.begin(); v != end; ++v) {
      weight += v->weight;
      if (weight > budget) return v->value;
    }
    return (end - 1)->value;
  }
}

}  // namespace atlas::param
