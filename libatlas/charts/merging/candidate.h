// Internal: a candidate for a merger of two charts.
#pragma once

#include <cstdint>
#include <tuple>

namespace atlas {

struct Candidate {
  double cost;
  std::uint32_t a, b, version_a, version_b;
  bool operator>(const Candidate& other) const {
    if (cost != other.cost) return cost > other.cost;
    return std::tie(a, b, version_a, version_b) >
           std::tie(other.a, other.b, other.version_a, other.version_b);
  }
};

}  // namespace atlas
