// Internal: the ways to solve a packing problem, and the choice between them.
#pragma once

#include "libatlas/pack/problem.h"

namespace atlas::pack {

// A reproducible generator of random numbers (SplitMix64, Steele et al. 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  // In [0, n), n below 2^32.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((next() >> 32) * n) >> 32);
  }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

// When a search ends: on reaching the bound, after this much work, or when the time is up.
struct SearchLimits {
  std::uint64_t layouts = 0;  // tried at most, all chains together; 0: no limit
  double seconds = 0;         // wall time
  std::uint64_t seed = 1;
  std::uint32_t chains = 1;        // independent searches, each on one thread at a time
  std::uint32_t enough_pages = 1;  // fewer are not looked for
  // Strips: part layouts that beam searches may keep, all together, and their wall time.
  std::uint64_t beam_states = 0;
  double beam_seconds = 0;
};

// Those of `standard` for so many items on pages.
SearchLimits standard_page_limits(std::size_t items);

// Solves by the preset. Fills in page_lower_bound, layouts_tried and curve of the result.
Layout solve(const Problem& problem, const PackOptions& options, const Context& context,
             PackResult& result);

// No packing of all items uses fewer pages (bins) or less height (a strip): by area, single sides,
// and dual feasible functions (Fekete and Schepers 2004).
std::uint32_t page_bound(const Problem& problem);
std::int64_t height_bound(const Problem& problem);

// Page after page, each gap of the skyline filled with the widest item that fits: O(n log n).
// Ignores pinned rectangles.
Layout pack_widest_first(const Problem& problem);

// Page after page by the scores of gap_fill.h, the items in this order; the same layout as
// GapFill's in O(n sqrt n) at worst, in about O(n log n) mostly. Ignores pinned rectangles.
Layout pack_gaps(const Problem& problem, std::span<const std::uint32_t> sequence);

// Local search for few pages: empties and refills two to four pages at a time. Starts from the best
// of the sorted orders. Ignores pinned rectangles.
Layout search_pages(const Problem& problem, const SearchLimits& limits, const Context& context,
                    PackResult& result);

// Local search for a low strip: swaps and moves in the order of the items, simulated annealing;
// where items may be turned, then beam searches below the height found.
Layout search_strip(const Problem& problem, const SearchLimits& limits, const Context& context,
                    PackResult& result);

// Local search over orders for first fit by maximal rectangles; honours pinned rectangles.
Layout search_first_fit(const Problem& problem, const SearchLimits& limits, const Context& context,
                        PackResult& result);

}  // namespace atlas::pack
