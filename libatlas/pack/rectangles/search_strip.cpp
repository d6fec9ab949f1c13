#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "libatlas/pack/rectangles/chains.h"
#include "libatlas/pack/rectangles/gap_fill.h"
#include "libatlas/pack/rectangles/strip_beam.h"
#include "libatlas/pack/rectangles/strip_chain.h"
#include "libatlas/pack/rectangles/turned_problem.h"

namespace atlas::pack {
namespace {

std::int32_t top_of(const Problem& problem, std::span<const GapPlacement> placed) {
  std::int32_t top = 0;
  for (const GapPlacement& g : placed) {
    const Extent e = problem.items[g.item];
    top = std::max(top, g.y + (g.rotated ? e.width : e.height));
  }
  return top;
}

// A sequence of items, and the layout that gaps filled in this order give.
struct Start {
  std::vector<std::uint32_t> sequence;
  std::int64_t height = INT64_MAX;
  std::vector<GapPlacement> placed;
};

// The items of a strip after turning them all alike, and their best start.
struct TurnedStrip {
  TurnedStrip(const Problem& problem, Turn turn) : turned(problem, turn) {}

  // Makes a layout of the turned items one of the strip's items.
  std::vector<GapPlacement> turned_back(std::vector<GapPlacement> placed) const {
    for (GapPlacement& g : placed) g.rotated = turned.turned(g.item);
    return placed;
  }

  TurnedProblem turned;
  Start start;
};

class StripSearch {
 public:
  StripSearch(const Problem& problem, const SearchLimits& limits, const Context& context,
              PackResult& result)
      : problem_(problem), limits_(limits), context_(context), result_(result) {}

  Layout run();

 private:
  bool done() const { return height_ <= bound_ || context_.cancelled(); }
  bool offer(std::vector<GapPlacement> placed);
  void offer_first_fit(const Problem& problem, Order order);
  Start lowest_order(const Problem& problem);
  void start_turned(Turn turn, std::optional<TurnedStrip>& strip);
  std::vector<GapPlacement> anneal(const Problem& problem, const Start& start,
                                   const SearchLimits& limits);
  void search_turned(const Start& free);
  bool run_beams(std::vector<StripBeam>& beams, StripBeam::Limits limits);
  void search_beams();

  const Problem& problem_;
  const SearchLimits& limits_;
  const Context& context_;
  PackResult& result_;
  std::int64_t bound_ = 0;  // no layout is lower than this, or has to be
  std::int64_t height_ = INT64_MAX;
  std::vector<GapPlacement> placed_;  // the lowest layout found so far
};

// Keeps the layout if it is the lowest so far. Returns whether it is.
bool StripSearch::offer(std::vector<GapPlacement> placed) {
  if (placed.size() < problem_.items.size()) return false;
  const std::int32_t top = top_of(problem_, placed);
  if (top >= height_) return false;
  height_ = top;
  placed_ = std::move(placed);
  return true;
}

// Offers a layout by maximal free rectangles. The problem has the items of the strip, perhaps
// turned.
void StripSearch::offer_first_fit(const Problem& problem, Order order) {
  const Layout layout =
      pack_first_fit(problem, sorted_items(problem.items, order), PlaceRule::bottom_left);
  ++result_.layouts_tried;
  if (layout.unplaced > 0) return;
  std::vector<GapPlacement> placed;
  for (std::uint32_t i = 0; i < layout.placements.size(); ++i) {
    const Placement& p = layout.placements[i];
    placed.push_back({i, p.x, p.y, p.rotated != (problem.items[i] != problem_.items[i])});
  }
  offer(std::move(placed));
}

// Returns the sorted order that gives the lowest layout.
Start StripSearch::lowest_order(const Problem& problem) {
  GapFill fill(problem.items, problem.page, problem.allow_rotation);
  Start lowest;
  for (Order order :
       {Order::area, Order::height, Order::width, Order::max_side, Order::perimeter}) {
    const std::vector<std::uint32_t> sequence = sorted_items(problem.items, order);
    std::vector<std::uint32_t> scratch = sequence;
    fill.clear();
    const std::int64_t height = fill.fill(scratch);
    ++result_.layouts_tried;
    if (height < lowest.height) lowest = {sequence, height, fill.placed()};
  }
  return lowest;
}

// Offers layouts of the items turned all alike, unless these cannot become low.
void StripSearch::start_turned(Turn turn, std::optional<TurnedStrip>& strip) {
  strip.emplace(problem_, turn);
  const Problem& turned = strip->turned.problem();
  if (done() || height_bound(turned) >= height_) return strip.reset();
  strip->start = lowest_order(turned);
  offer(strip->turned_back(strip->start.placed));
  if (!done()) offer_first_fit(turned, Order::height);
}

// Anneals chains from this start. Returns the lowest layout found.
std::vector<GapPlacement> StripSearch::anneal(const Problem& problem, const Start& start,
                                              const SearchLimits& limits) {
  std::vector<StripChain> chains;
  for (std::uint32_t c = 0; c < limits.chains; ++c) {
    chains.emplace_back(problem, bound_, limits.seed * 0x10001 + c);
    chains.back().start(start.sequence);
  }
  return chains[run_chains(chains, limits, context_, result_)].best();
}

// Gap filling has no rule that lays long items down, since an open strip has room for them to
// stand, and one that stands can be several times as high as the layout need be. Annealing from
// such a start does not lay them all down. So items that all lie, all stand, or are not turned are
// tried as well, and annealed if this is much lower. If it is a little lower, annealing and beams
// from the free start get lower on average. What the search would find if it must not turn items is
// looked for in full, so that being allowed to turn them costs no height.
void StripSearch::search_turned(const Start& free) {
  constexpr double kMuchLower = 0.95;
  std::array<std::optional<TurnedStrip>, 2> alike;
  std::optional<TurnedStrip> unturned;
  start_turned(Turn::lying, alike[0]);
  start_turned(Turn::standing, alike[1]);
  start_turned(Turn::none, unturned);
  for (const Order order : {Order::max_side, Order::perimeter, Order::height})
    if (!done()) offer_first_fit(problem_, order);
  const TurnedStrip* lowest = nullptr;
  auto least = static_cast<std::int64_t>(kMuchLower * static_cast<double>(free.height));
  for (const std::optional<TurnedStrip>& strip : alike) {
    if (!strip || strip->start.height >= least) continue;
    lowest = &*strip;
    least = strip->start.height;
  }
  if (!done()) {
    if (lowest)
      offer(lowest->turned_back(anneal(lowest->turned.problem(), lowest->start, limits_)));
    else
      offer(anneal(problem_, free, limits_));
  }
  if (done() || !unturned || limits_.unturned_layouts == 0) return;
  if (height_bound(unturned->turned.problem()) >= height_) return;
  SearchLimits limits = limits_;
  limits.layouts = limits_.unturned_layouts;
  limits.seconds = limits_.unturned_seconds;
  offer(unturned->turned_back(anneal(unturned->turned.problem(), unturned->start, limits)));
}

// Runs the beams side by side. They prefer large items to different degrees. The lowest layout of
// all is used, so that the result does not depend on the number of threads.
bool StripSearch::run_beams(std::vector<StripBeam>& beams, StripBeam::Limits limits) {
  constexpr std::array kLargeFirst{3.0, 2.0, 4.0, 1.5};
  std::vector<std::vector<GapPlacement>> found(beams.size());
  const auto run = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      StripBeam::Limits own = limits;
      own.large_first = kLargeFirst[k];
      found[k] = beams[k].pack(own);
    }
  };
  parallel_for(context_, beams.size(), 1, run);
  bool lower = false;
  for (std::vector<GapPlacement>& layout : found) lower |= offer(std::move(layout));
  return lower;
}

// Runs beam searches of increasing width, each below the lowest height known. The beams double if
// none of them finds a layout.
void StripSearch::search_beams() {
  const double begun = wall_seconds();
  const auto stop = [&] {
    return context_.cancelled() || wall_seconds() - begun > limits_.beam_seconds;
  };
  std::vector<StripBeam> beams(
      4, StripBeam(problem_.items, problem_.page.width, problem_.allow_rotation));
  // This limits memory, since a state has up to four children per item.
  const std::size_t widest = std::max<std::size_t>(8, 1'000'000 / problem_.items.size());
  std::uint64_t left = limits_.beam_states;
  for (std::size_t states = 4; states <= widest && height_ > bound_ && !stop();) {
    if (left < states * beams.size()) return;
    left -= states * beams.size();
    result_.layouts_tried += states * beams.size();
    if (!run_beams(beams, {static_cast<std::int32_t>(height_ - 1), states, 0, stop})) states *= 2;
  }
}

Layout StripSearch::run() {
  result_.page_lower_bound = 1;
  bound_ = std::max(height_bound(problem_), limits_.enough_height);
  const Start start = lowest_order(problem_);
  offer(start.placed);
  // With a single layout, strips of many widths are compared; the search follows.
  if (problem_.allow_rotation && limits_.layouts != 1)
    search_turned(start);
  else
    offer(anneal(problem_, start, limits_));
  if (limits_.beam_states > 0) search_beams();
  // A single pass takes little time, and now and then it is lower than all that was searched. It
  // also places what it can where the largest height has no room for all items, which ends the
  // search without a layout.
  if (!done() && (limits_.layouts != 1 || placed_.empty())) {
    Layout widest = pack_widest_first(problem_);
    ++result_.layouts_tried;
    if (widest.unplaced == 0 ? widest.last_used < height_ : placed_.empty()) return widest;
  }
  Layout layout;
  layout.placements.resize(problem_.items.size());
  layout.pages = 1;
  layout.last_used = height_;
  for (const GapPlacement& g : placed_) layout.placements[g.item] = {0, g.x, g.y, g.rotated};
  return layout;
}

}  // namespace

Layout search_strip(const Problem& problem, const SearchLimits& limits, const Context& context,
                    PackResult& result) {
  return StripSearch(problem, limits, context, result).run();
}

}  // namespace atlas::pack
