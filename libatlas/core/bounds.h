// Internal: boxes that grow by points.
#pragma once

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

namespace atlas {

// The smallest box around the points that were added; V is a vector of GLM. Before the first point,
// `low` is above `high`, and the box meets nothing.
template <class V>
struct Bounds {
  using Number = typename V::value_type;
  static constexpr Number kFar = std::numeric_limits<Number>::infinity();

  V low{kFar}, high{-kFar};

  void add(const V& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  V size() const { return high - low; }
  // Returns whether the boxes are within `reach` of each other along all axes.
  bool meets(const Bounds& other, Number reach = 0) const {
    return glm::all(glm::lessThanEqual(low, other.high + reach)) &&
           glm::all(glm::lessThanEqual(other.low, high + reach));
  }
};

}  // namespace atlas
