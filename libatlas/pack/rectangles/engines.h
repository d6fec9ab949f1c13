// Internal: the engines that solve a packing problem, and the choice between them.
#pragma once

#include "libatlas/pack/rectangles/problem.h"

namespace atlas::pack {

// Limits of a search. A search ends when it reaches the bound, has done this much work, or has used
// up its time.
struct SearchLimits {
  // Maximum number of layouts tried by all chains together; 0: no limit.
  std::uint64_t layouts = 0;
  double seconds = 0;  // wall time
  std::uint64_t seed = 1;
  std::uint32_t chains = 1;  // independent searches, each of which runs on one thread at a time
  std::uint32_t enough_pages = 1;  // the search does not try to use fewer pages than this
  // For strips: the number of partial layouts that all beam searches together may keep, and their
  // wall time.
  std::uint64_t beam_states = 0;
  double beam_seconds = 0;
  // For strips whose items may be turned: the maximum number of layouts that are tried without
  // turning any, and the wall time for them.
  std::uint64_t unturned_layouts = 0;
  double unturned_seconds = 0;
  // For pages: whether layouts of other engines are offered as starts, and how many layouts may be
  // tried to join the last two pages (0: none), in how much wall time.
  bool other_starts = false;
  std::uint64_t join_layouts = 0;
  double join_seconds = 0;
  // For strips: a layout that is no higher than this is low enough.
  std::int64_t enough_height = 0;
};

// Returns the limits of `standard` for this number of items on pages.
SearchLimits standard_page_limits(std::size_t items);

// Returns the limits of the preset, for a strip or for pages. No time is NaN, also if the budget is
// infinite.
SearchLimits limits_for(const Problem& problem, const PackOptions& options, bool strip);

// Returns the limits of `standard` for these items on a strip, cut to those for joining pages.
SearchLimits limits_to_join(const Problem& strip, const SearchLimits& pages);

// Solves the problem according to the preset. Fills in page_lower_bound of the result and adds to
// its layouts_tried.
Layout solve(const Problem& problem, const PackOptions& options, const Context& context,
             PackResult& result);

// Lower bounds: no packing of all items uses fewer pages (bins) or less height (a strip). The bound
// on pages follows from the area alone, which takes no time, or from dual feasible functions
// (Fekete and Schepers 2004); the bound on height follows from the area and from single sides.
std::uint32_t area_bound(const Problem& problem);
std::uint32_t page_bound(const Problem& problem);
std::int64_t height_bound(const Problem& problem);

// Fills page after page. Each gap of the skyline gets the widest item that fits: O(n log n).
// Ignores pinned rectangles.
Layout pack_widest_first(const Problem& problem);

// Fills page after page with the items in this order, by the scores of gap_fill.h. The layout is
// the same as that of GapFill. It takes O(n sqrt n) at worst and mostly about O(n log n). Ignores
// pinned rectangles.
Layout pack_gaps(const Problem& problem, std::span<const std::uint32_t> sequence);

// Local search for few pages, which empties and refills two to four pages at a time. It starts from
// the best of the sorted orders. Ignores pinned rectangles.
Layout search_pages(const Problem& problem, const SearchLimits& limits, const Context& context,
                    PackResult& result);

// Local search for a low strip. It changes the order of the items by swaps and moves, with
// simulated annealing. Items that may be turned are also tried all lying, all standing and
// unturned. If limits.beam_states is not 0, beam searches below the height found follow.
Layout search_strip(const Problem& problem, const SearchLimits& limits, const Context& context,
                    PackResult& result);

// Local search over orders for first fit by maximal rectangles. Respects pinned rectangles.
Layout search_first_fit(const Problem& problem, const SearchLimits& limits, const Context& context,
                        PackResult& result);

}  // namespace atlas::pack
