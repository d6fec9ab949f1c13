// Internal: what mergers cost, so that rounding does not decide which comes first.
#pragma once

#include <algorithm>
#include <set>

namespace atlas {

// Gives costs that differ by less than `tie` one value, that of the first of them: symmetric meshes
// are full of ties, which rounding would break otherwise for every rotation and unit.
class CostClasses {
 public:
  static constexpr double tie = 1e-4;
  static constexpr double most = 1e9;  // what is no number, as that of cells without area, costs it

  double operator()(double cost) {
    const double own = std::min(most, cost);
    const auto at = values_.lower_bound(own - tie);
    return at != values_.end() && *at <= own + tie ? *at : *values_.insert(at, own);
  }

 private:
  std::set<double> values_;
};

}  // namespace atlas
