// Internal: runs independent searches in rounds, so that the result depends on the number of rounds
// only, never on the number of threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/pack/rectangles/engines.h"

namespace atlas::pack {

// A Chain has step(), which tries one layout, done(), which says that the bound is reached, and
// cost(), by which chains are compared (pages, then last_used; smaller is better). In a round all
// chains make the same number of steps. The clock is read between rounds only. Returns the index of
// the best chain. On a tie the earlier choice stays.
template <class Chain>
std::size_t run_chains(std::vector<Chain>& chains, const SearchLimits& limits,
                       const Context& context, PackResult& result) {
  const double start = wall_seconds();
  std::size_t best = 0;
  const auto choose = [&] {
    for (std::size_t c = 0; c < chains.size(); ++c)
      if (chains[c].cost() < chains[best].cost()) best = c;
  };
  choose();
  std::uint64_t per_round = 1, left = limits.layouts ? limits.layouts : UINT64_MAX;
  while (!chains[best].done() && left > 0 && !context.cancelled()) {
    const double elapsed = wall_seconds() - start;
    if (elapsed >= limits.seconds) break;
    const std::uint64_t steps =
        std::max<std::uint64_t>(1, std::min(per_round, left / chains.size()));
    const auto run = [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c)
        for (std::uint64_t s = 0; s < steps && !chains[c].done(); ++s) chains[c].step();
    };
    if (chains.size() == 1)
      run(0, 1);
    else
      parallel_for(context, chains.size(), 1, run);
    left -= std::min(left, steps * chains.size());
    result.layouts_tried += steps * chains.size();
    choose();
    // Rounds grow to about a fiftieth of the time budget, so that reading the clock costs nothing.
    const double round = wall_seconds() - start - elapsed;
    if (round * 50 < limits.seconds && per_round < 4096) per_round *= 2;
    if (std::isfinite(limits.seconds) && limits.seconds > 0)
      context.report("packing", std::min(1.0, elapsed / limits.seconds));
  }
  return best;
}

}  // namespace atlas::pack
