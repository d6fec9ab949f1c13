// Internal: a candidate for a merger of two charts.
#pragma once

#include <cstdint>

namespace atlas {

struct Candidate {
  double cost;
  std::uint32_t a, b, version_a, version_b;
  bool operator>(const Candidate& other) const {
    if (cost != other.cost) return cost > other.cost;
    return a != other.a ? a > other.a : b > other.b;
  }
};

}  // namespace atlas
