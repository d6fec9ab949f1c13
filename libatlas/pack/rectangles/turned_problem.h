// Internal: packing problems whose items have been turned beforehand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/pack/rectangles/problem.h"

namespace atlas::pack {

enum class Turn { none, standing, lying };

// The same problem with items that may not be turned, after turning all alike. Items that would not
// fit the page keep the other direction.
class TurnedProblem {
 public:
  TurnedProblem(const Problem& problem, Turn turn);
  TurnedProblem(const TurnedProblem&) = delete;  // the problem points at the items

  const Problem& problem() const { return problem_; }
  bool turned(std::size_t item) const { return items_[item] != original_[item]; }
  // Makes a layout of problem() one of the original problem.
  void turn_back(Layout& layout) const;

 private:
  Problem problem_;
  std::span<const Extent> original_;
  std::vector<Extent> items_;
};

}  // namespace atlas::pack
