#include <limits>

#include "libatlas/pack/engines.h"

namespace atlas::pack {
namespace {

// `standard` stops after this much work, counted in looks at an item: 500 instances of 20 to 100
// items take about 0.1 s, a strip of 200 items 0.05 to 0.1 s.
constexpr std::uint64_t kPageWork = 160'000, kStripWork = 25'000'000, kBeamWork = 3'000'000;

// Above this many items the gap engines, quadratic in the items of a page, are not the ones to ask.
constexpr std::size_t kSmall = 1000;

SearchLimits limits_for(const Problem& problem, const PackOptions& options, bool strip) {
  SearchLimits limits;
  limits.seed = options.seed;
  // Without turns beams seldom find what annealing does not.
  const bool beams = strip && options.allow_rotation;
  if (options.preset == PackPreset::best) {
    limits.layouts = options.effort;
    limits.seconds = options.time_budget;
    limits.chains = 4;
    if (beams) {
      limits.seconds = 0.3 * options.time_budget;
      limits.beam_seconds = options.time_budget - limits.seconds;
      limits.layouts = (options.effort + 2) / 3;
      limits.beam_states = options.effort > 0 ? options.effort - limits.layouts : UINT64_MAX;
    }
    return limits;
  }
  const std::uint64_t n = problem.items.size();
  limits.seconds = std::numeric_limits<double>::infinity();
  limits.layouts = 1 + (strip ? kStripWork / (n * n / 2 + 1000) : kPageWork / (8 * n + 200));
  if (beams) {
    limits.layouts = 1 + limits.layouts / 3;
    limits.beam_seconds = limits.seconds;
    limits.beam_states = kBeamWork / (2 * n * n + 1000);
  }
  return limits;
}

Layout better(Layout a, Layout b) {
  return b.better_than(a) ? std::move(b) : std::move(a);
}

}  // namespace

Layout solve(const Problem& problem, const PackOptions& options, const Context& context,
             PackResult& result) {
  if (problem.items.empty()) return {};
  const bool strip = options.page.height == 0;
  const SearchLimits limits = limits_for(problem, options, strip);
  if (options.engine != PackEngine::automatic) {
    const std::vector<std::uint32_t> order = sorted_items(problem.items, Order::height);
    result.layouts_tried = 1;
    result.page_lower_bound = strip ? 1 : page_bound(problem);
    if (options.engine == PackEngine::max_rects)
      return pack_first_fit(problem, order, PlaceRule::bottom_left);
    return pack_skyline(problem, order,
                        options.engine == PackEngine::skyline_min_waste ? PlaceRule::min_waste
                                                                        : PlaceRule::bottom_left);
  }
  if (!problem.pinned.empty()) {
    SearchLimits pinned = limits;
    if (options.preset != PackPreset::best) pinned.layouts = 1;
    return search_first_fit(problem, pinned, context, result);
  }
  if (options.preset == PackPreset::fast) {
    result.page_lower_bound = 1;
    result.layouts_tried = 1;
    return pack_widest_first(problem);
  }
  if (problem.items.size() <= kSmall)
    return strip ? search_strip(problem, limits, context, result)
                 : search_pages(problem, limits, context, result);
  result.page_lower_bound = strip ? 1 : page_bound(problem);
  if (!strip && options.preset == PackPreset::best) {
    Layout searched = search_first_fit(problem, limits, context, result);
    return better(std::move(searched), pack_widest_first(problem));
  }
  result.layouts_tried = strip ? 2 : 1;
  Layout by_height =
      pack_first_fit(problem, sorted_items(problem.items, Order::height), PlaceRule::bottom_left);
  return strip ? better(pack_widest_first(problem), std::move(by_height)) : by_height;
}

}  // namespace atlas::pack
