// Internal: annealing of the order in which the items of a strip are placed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/core/portable_math.h"
#include "libatlas/core/random.h"
#include "libatlas/pack/rectangles/engines.h"
#include "libatlas/pack/rectangles/gap_fill.h"

namespace atlas::pack {

// One search over sequences. The strip is filled gap by gap, and the sequence decides between items
// that fit a gap equally well. The evaluation is that of Leung et al. 2011; the neighbourhood
// consists of their swaps and of moves of one item.
class StripChain {
 public:
  StripChain(const Problem& problem, std::int64_t bound, std::uint64_t seed)
      : fill_(problem.items, problem.page, problem.allow_rotation), bound_(bound), random_(seed) {}

  // Starts from this sequence and remembers its layout as the best one.
  void start(std::vector<std::uint32_t> sequence) {
    current_ = std::move(sequence);
    current_height_ = evaluate(current_);
    best_height_ = current_height_;
    best_ = fill_.placed();
  }

  bool done() const { return best_height_ <= bound_; }
  std::pair<std::uint32_t, std::int64_t> cost() const { return {1, best_height_}; }
  const std::vector<GapPlacement>& best() const { return best_; }

  void step() {
    const auto n = static_cast<std::uint32_t>(current_.size());
    if (n < 2) return;
    candidate_ = current_;
    const std::uint32_t i = random_.below(n);
    std::uint32_t j = random_.below(n - 1);
    j += j >= i;
    const auto at = [&](std::uint32_t k) { return candidate_.begin() + k; };
    if (random_.below(2))
      std::swap(candidate_[i], candidate_[j]);
    else if (i < j)
      std::rotate(at(i), at(i + 1), at(j + 1));
    else
      std::rotate(at(j), at(i), at(i + 1));
    const std::int64_t height = evaluate(candidate_);
    cool_down();
    const double rise = static_cast<double>(height - current_height_);
    if (rise <= 0 || random_.unit() < portable::exp(-rise / temperature_)) {
      current_ = candidate_;
      current_height_ = height;
    }
    if (height < best_height_) {
      best_height_ = height;
      best_ = fill_.placed();
    }
  }

 private:
  std::int64_t evaluate(const std::vector<std::uint32_t>& sequence) {
    scratch_ = sequence;
    fill_.clear();
    return fill_.fill(scratch_);
  }

  // The temperature falls linearly from 1 % of the height to zero within a cycle, and each cycle is
  // twice as long as the last. Cycles are counted in steps instead of seconds, so that runs are
  // repeatable.
  void cool_down() {
    if (++step_ >= cycle_) {
      step_ = 0;
      cycle_ *= 2;
    }
    const double left = 1 - static_cast<double>(step_) / static_cast<double>(cycle_);
    temperature_ = std::max(1e-9, 0.01 * left * static_cast<double>(best_height_));
  }

  GapFill fill_;
  std::int64_t bound_;
  Random random_;
  std::vector<std::uint32_t> current_, candidate_, scratch_;
  std::int64_t current_height_ = 0, best_height_ = 0;
  std::vector<GapPlacement> best_;
  std::uint64_t step_ = 0, cycle_ = 1000;
  double temperature_ = 1;
};

}  // namespace atlas::pack
