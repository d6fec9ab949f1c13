#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/pack/chains.h"
#include "libatlas/pack/gap_fill.h"
#include "libatlas/pack/strip_beam.h"

namespace atlas::pack {
namespace {

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
    if (rise <= 0 || random_.unit() < std::exp(-rise / temperature_)) {
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

std::int32_t top_of(const Problem& problem, std::span<const GapPlacement> placed) {
  std::int32_t top = 0;
  for (const GapPlacement& g : placed) {
    const Extent e = problem.items[g.item];
    top = std::max(top, g.y + (g.rotated ? e.width : e.height));
  }
  return top;
}

// A strip and the lowest layout found so far.
struct LowStrip {
  const Problem& problem;
  std::int64_t bound = 0;  // no layout is lower than this
  std::int64_t height = 0;
  std::vector<GapPlacement> placed;
};

// Copies layouts that are lower than `low` into it. Returns whether there was any.
bool lower(std::span<std::vector<GapPlacement>> found, LowStrip& low) {
  const std::int64_t before = low.height;
  for (std::vector<GapPlacement>& layout : found) {
    if (layout.empty()) continue;
    const std::int32_t top = top_of(low.problem, layout);
    if (top >= low.height) continue;
    low.height = top;
    low.placed = std::move(layout);
  }
  return low.height < before;
}

// Runs beam searches of increasing width, each below the lowest height known. Four run at a time,
// which prefer large items to different degrees. The lowest layout of the four is used, so that the
// result does not depend on the number of threads. The beam doubles if none of them finds a layout.
void search_beams(LowStrip& low, const SearchLimits& limits, const Context& context,
                  PackResult& result) {
  const Problem& problem = low.problem;
  constexpr std::array kLargeFirst{3.0, 2.0, 4.0, 1.5};
  const double begun = wall_seconds();
  const auto stop = [&] {
    return context.cancelled() || wall_seconds() - begun > limits.beam_seconds;
  };
  std::vector<StripBeam> beams(
      kLargeFirst.size(), StripBeam(problem.items, problem.page.width, problem.allow_rotation));
  // This limits memory, since a state has up to four children per item.
  const std::size_t widest = std::max<std::size_t>(8, 1'000'000 / problem.items.size());
  std::uint64_t left = limits.beam_states;
  double last = begun;
  for (std::size_t states = 4; states <= widest && low.height > low.bound && !stop();) {
    if (left < states * beams.size()) return;
    left -= states * beams.size();
    result.layouts_tried += states * beams.size();
    std::vector<std::vector<GapPlacement>> found(beams.size());
    const auto run = [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        found[k] = beams[k].pack(
            {static_cast<std::int32_t>(low.height - 1), states, kLargeFirst[k], stop});
    };
    parallel_for(context, beams.size(), 1, run);
    if (!lower(found, low)) {
      states *= 2;
      continue;
    }
    const double seconds = result.curve.empty() ? 0 : result.curve.back().seconds;
    result.curve.push_back({seconds + wall_seconds() - last, result.layouts_tried, 1, low.height});
    last = wall_seconds();
  }
}

}  // namespace

Layout search_strip(const Problem& problem, const SearchLimits& limits, const Context& context,
                    PackResult& result) {
  GapFill fill(problem.items, problem.page, problem.allow_rotation);
  std::vector<std::uint32_t> start;
  std::int64_t lowest = 0;
  for (Order order :
       {Order::area, Order::height, Order::width, Order::max_side, Order::perimeter}) {
    std::vector<std::uint32_t> sequence = sorted_items(problem.items, order), scratch = sequence;
    fill.clear();
    const std::int64_t height = fill.fill(scratch);
    ++result.layouts_tried;
    if (!start.empty() && height >= lowest) continue;
    lowest = height;
    start = std::move(sequence);
  }
  const std::int64_t bound = height_bound(problem);
  result.page_lower_bound = 1;
  std::vector<StripChain> chains;
  for (std::uint32_t c = 0; c < limits.chains; ++c) {
    chains.emplace_back(problem, bound, limits.seed * 0x10001 + c);
    chains.back().start(start);
  }
  const std::size_t best = run_chains(chains, limits, context, result);
  Layout layout;
  layout.placements.resize(problem.items.size());
  layout.pages = 1;
  LowStrip low{problem, bound, chains[best].cost().second, chains[best].best()};
  if (limits.beam_states > 0) search_beams(low, limits, context, result);
  layout.last_used = low.height;
  for (const GapPlacement& g : low.placed) layout.placements[g.item] = {0, g.x, g.y, g.rotated};
  return layout;
}

}  // namespace atlas::pack
