// Internal: percentiles of weighted values in linear time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "libatlas/core/sort_total.h"

namespace atlas::param {

struct WeightedValue {
  double value, weight;
};

inline bool larger(const WeightedValue& a, const WeightedValue& b) {
  return a.value != b.value ? a.value > b.value : a.weight > b.weight;
}

// Returns the smallest value such that the weight of larger values is at most `budget`; 0 if there
// are no values. Reorders the values.
inline double value_above_budget(std::vector<WeightedValue>& values, double budget) {
  if (values.empty()) return 0;
  // Only the upper tail has to be sorted. Takes a longer one until it exceeds the budget.
  for (std::size_t tail = values.size() / 256 + 16;; tail *= 4) {
    tail = std::min(tail, values.size());
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(tail);
    if (tail < values.size()) nth_total(values.begin(), end, values.end(), larger);
    sort_total(values.begin(), end, larger);
    double weight = 0;
    for (auto v = values.begin(); v != end; ++v) {
      weight += v->weight;
      if (weight > budget) return v->value;
    }
    if (tail == values.size()) return (end - 1)->value;
  }
}

// The same for a budget of `share` of the total weight.
inline double upper_percentile(std::vector<WeightedValue>& values, double share) {
  double total = 0;
  for (const WeightedValue& v : values) total += v.weight;
  return value_above_budget(values, share * total);
}

// Collects, from values that arrive one by one, those that value_above_budget() may need for
// budgets up to `budget`: a small part of the values of a large chart.
class UpperTail {
 public:
  explicit UpperTail(double budget) : budget_(budget) {}

  void add(double value, double weight) {
    if (value <= floor_) return;
    values_.push_back({value, weight});
    if (values_.size() >= most_) prune();
  }
  std::vector<WeightedValue>& values() { return values_; }

 private:
  void prune() {
    sort_total(values_.begin(), values_.end(), larger);
    double weight = 0;
    std::size_t kept = 0;
    while (kept < values_.size() && weight <= budget_) weight += values_[kept++].weight;
    if (weight > budget_) floor_ = values_[kept - 1].value;
    values_.resize(kept);
    most_ = std::max(most_, 4 * kept);
  }

  double budget_, floor_ = 0;
  std::size_t most_ = 20000;
  std::vector<WeightedValue> values_;
};

}  // namespace atlas::param
