#include <algorithm>
#include <limits>

#include "libatlas/pack/rectangles/engines.h"
#include "libatlas/pack/rectangles/turned_problem.h"

namespace atlas::pack {
namespace {

// `standard` stops after this much work, counted as examinations of an item. 500 instances of 20 to
// 100 items take about 0.1 s, a strip of 200 items 0.05 to 0.1 s.
constexpr std::uint64_t kPageWork = 160'000, kStripWork = 25'000'000, kBeamWork = 3'000'000;

// Above this number of items, the gap engines that examine every item are not used, because they
// take quadratic time in the items of a page.
constexpr std::size_t kSmall = 1000;

// The shares of the time of `best`. Times are products, never differences, because the budget may
// be infinite.
constexpr double kAnnealed = 0.3, kUnturned = 0.1, kJoined = 0.1;

// Takes a tenth of the effort and time of `best` from the beams for layouts without turns.
void share_with_unturned(const PackOptions& options, SearchLimits& limits) {
  limits.unturned_seconds = kUnturned * options.time_budget;
  limits.beam_seconds = (1 - kAnnealed - kUnturned) * options.time_budget;
  limits.unturned_layouts = options.effort > 0 ? (options.effort + 9) / 10 : UINT64_MAX;
  if (options.effort > 0)
    limits.beam_states -= std::min(limits.beam_states, limits.unturned_layouts);
}

// Takes a tenth of the effort and time of `best` for joining two pages.
void share_with_join(const PackOptions& options, SearchLimits& limits) {
  limits.other_starts = true;
  limits.join_seconds = kJoined * options.time_budget;
  limits.seconds = (1 - kJoined) * options.time_budget;
  limits.join_layouts = options.effort > 0 ? options.effort / 10 : UINT64_MAX;
  if (options.effort > 0) limits.layouts -= limits.join_layouts;
}

Layout better(Layout a, Layout b) {
  return b.better_than(a) ? std::move(b) : std::move(a);
}

Layout pack_by(const Problem& problem, Order order) {
  return pack_gaps(problem, sorted_items(problem.items, order));
}

// Packs all items after turning them alike, except for those that would not fit.
template <class Pack>
Layout pack_turned(const Problem& problem, Turn turn, const Pack& pack) {
  const TurnedProblem turned(problem, turn);
  Layout layout = pack(turned.problem());
  turned.turn_back(layout);
  return layout;
}

// On a page with more items than this, the lists of free rectangles become long: 2 10^5 items took
// up to nine seconds, for a gain of a thousandth of the height.
constexpr std::size_t kMostOnAPage = 50'000;

// Packs by maximal free rectangles, or by gaps if a page has too many items for them. In large
// sets, choosing each item's direction by the hole at hand loses more than it gains, because the
// items then no longer come in order of their heights.
Layout pack_by_height(const Problem& problem, std::uint32_t pages) {
  const auto pack = [&](const Problem& fixed) {
    return fixed.items.size() / pages > kMostOnAPage
               ? pack_by(fixed, Order::height)
               : pack_first_fit(fixed, sorted_items(fixed.items, Order::height),
                                PlaceRule::bottom_left);
  };
  if (!problem.allow_rotation) return pack(problem);
  Layout best = pack_turned(problem, Turn::none, pack);
  for (const Turn turn : {Turn::standing, Turn::lying})
    if (!problem.cancelled()) best = better(std::move(best), pack_turned(problem, turn, pack));
  return best;
}

// If items may be turned, the layouts without turns are among those tried. Long bars of about the
// same length get the lowest strip if each is turned as its place demands, in order of length. This
// takes 0.1 s for 5000 items, and four times as long for twice as many, so it is left out for more,
// and where at most a hundredth of the height can be won.
Layout pack_large_strip(const Problem& problem) {
  constexpr std::size_t kMostTurnedFreely = 5000;
  constexpr double kWorthIt = 1.01;
  Layout best = better(pack_widest_first(problem), pack_by_height(problem, 1));
  if (!problem.allow_rotation) return best;
  if (problem.search_unturned)
    best = better(std::move(best), pack_turned(problem, Turn::none, pack_widest_first));
  const double least = kWorthIt * static_cast<double>(height_bound(problem));
  if (problem.items.size() > kMostTurnedFreely || problem.cancelled() ||
      static_cast<double>(best.last_used) <= least)
    return best;
  return better(std::move(best),
                pack_first_fit(problem, sorted_items(problem.items, Order::max_side),
                               PlaceRule::bottom_left));
}

// Gaps filled in order of area need the fewest pages: 2 to 6 % fewer than other engines if a page
// holds ten items. Free rectangles give the lowest single page. If pages hold at most a few
// thousand items, they take half the time and often need no more pages than the bound, so they are
// tried first.
Layout pack_large_pages(const Problem& problem, const PackOptions& options, std::uint32_t bound) {
  constexpr std::size_t kFewOnAPage = 5000;
  const bool quick = !problem.allow_rotation && problem.items.size() / bound <= kFewOnAPage;
  Layout best = quick ? pack_by_height(problem, bound) : pack_by(problem, Order::area);
  const auto done = [&] {
    const bool fewest = best.pages <= bound && best.unplaced == 0 && !options.crop;
    return fewest || problem.cancelled();
  };
  if (done()) return best;
  if (quick) best = better(std::move(best), pack_by(problem, Order::area));
  if (!done()) best = better(std::move(best), pack_widest_first(problem));
  if (!done()) best = better(std::move(best), pack_by(problem, Order::height));
  if (!done() && (options.crop || (!problem.allow_rotation && !quick))) {
    const std::uint32_t pages = std::max(1u, best.pages);
    best = better(std::move(best), pack_by_height(problem, pages));
  }
  return best;
}

}  // namespace

SearchLimits standard_page_limits(std::size_t items) {
  SearchLimits limits;
  limits.seconds = std::numeric_limits<double>::infinity();
  limits.layouts = 1 + kPageWork / (8 * items + 200);
  return limits;
}

SearchLimits limits_for(const Problem& problem, const PackOptions& options, bool strip) {
  SearchLimits limits;
  limits.seed = options.seed;
  // If items may not be turned, beam searches seldom find a better layout than annealing.
  const bool beams = strip && problem.allow_rotation;
  if (options.preset == PackPreset::best) {
    limits.layouts = options.effort;
    limits.seconds = options.time_budget;
    limits.chains = 4;
    if (!strip) share_with_join(options, limits);
    if (beams) {
      limits.seconds = kAnnealed * options.time_budget;
      limits.beam_seconds = (1 - kAnnealed) * options.time_budget;
      limits.layouts = (options.effort + 2) / 3;
      limits.beam_states = options.effort > 0 ? options.effort - limits.layouts : UINT64_MAX;
      if (problem.search_unturned) share_with_unturned(options, limits);
    }
    return limits;
  }
  limits.other_starts = !strip;
  limits.join_layouts = strip ? 0 : UINT64_MAX;
  limits.join_seconds = std::numeric_limits<double>::infinity();
  const std::uint64_t n = problem.items.size();
  limits.seconds = std::numeric_limits<double>::infinity();
  limits.layouts = strip ? 1 + kStripWork / (n * n / 2 + 1000) : standard_page_limits(n).layouts;
  if (beams) {
    if (problem.search_unturned) limits.unturned_layouts = limits.layouts;
    limits.unturned_seconds = limits.seconds;
    limits.layouts = 1 + limits.layouts / 3;
    limits.beam_seconds = limits.seconds;
    limits.beam_states = kBeamWork / (2 * n * n + 1000);
  }
  return limits;
}

SearchLimits limits_to_join(const Problem& strip, const SearchLimits& pages) {
  PackOptions options;
  options.seed = pages.seed;
  SearchLimits limits = limits_for(strip, options, true);
  for (std::uint64_t* layouts : {&limits.layouts, &limits.unturned_layouts, &limits.beam_states})
    *layouts = std::min(*layouts, pages.join_layouts);
  limits.layouts = std::max<std::uint64_t>(1, limits.layouts);  // 0 is no limit
  for (double* seconds : {&limits.seconds, &limits.unturned_seconds, &limits.beam_seconds})
    *seconds = pages.join_seconds / 3;
  return limits;
}

Layout solve(const Problem& problem, const PackOptions& options, const Context& context,
             PackResult& result) {
  if (problem.items.empty()) return {};
  const bool strip = options.page.height == 0;
  result.page_lower_bound = strip ? 1 : area_bound(problem);
  const SearchLimits limits = limits_for(problem, options, strip);
  if (options.engine != PackEngine::automatic) {
    const std::vector<std::uint32_t> order = sorted_items(problem.items, Order::height);
    ++result.layouts_tried;
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
    ++result.layouts_tried;
    return pack_widest_first(problem);
  }
  if (problem.items.size() <= kSmall) {
    if (strip) return search_strip(problem, limits, context, result);
    Layout searched = search_pages(problem, limits, context, result);
    if (searched.unplaced == 0) return searched;
    // The search looks for few pages. If too few are allowed, a single pass may place more items.
    return better(std::move(searched), pack_widest_first(problem));
  }
  result.page_lower_bound = strip ? 1 : page_bound(problem);
  if (strip || options.preset != PackPreset::best) result.layouts_tried += strip ? 2 : 1;
  if (strip) return pack_large_strip(problem);
  if (options.preset != PackPreset::best)
    return pack_large_pages(problem, options, result.page_lower_bound);
  Layout searched = search_first_fit(problem, limits, context, result);
  return better(std::move(searched), pack_large_pages(problem, options, result.page_lower_bound));
}

}  // namespace atlas::pack
