#include <compare>
#include <cstdint>

#include "libatlas/core/random.h"
#include "libatlas/pack/rectangles/chains.h"

namespace atlas::pack {
namespace {

// Compares like Layout::better_than(). The names are those of the pairs of other chains.
struct OrderCost {
  std::uint32_t unplaced, first;  // items; pages
  std::int64_t second;            // last_used
  auto operator<=>(const OrderCost&) const = default;
};

// Hill climbing over orders for first fit. A layout takes longer than with the gap searches, but
// pinned rectangles are respected.
class OrderChain {
 public:
  OrderChain(const Problem& problem, std::uint64_t seed) : problem_(problem), random_(seed) {}

  void start(std::vector<std::uint32_t> order, Layout layout) {
    order_ = std::move(order);
    best_ = std::move(layout);
  }
  bool done() const { return order_.size() < 2; }
  OrderCost cost() const { return {best_.unplaced, best_.pages, best_.last_used}; }
  const Layout& best() const { return best_; }

  void step() {
    std::vector<std::uint32_t> candidate = order_;
    const auto n = static_cast<std::uint32_t>(candidate.size());
    for (std::uint32_t k = 1 + random_.below(3); k > 0; --k)
      std::swap(candidate[random_.below(n)], candidate[random_.below(n)]);
    const PlaceRule rule =
        random_.below(2) && n < 1000 ? PlaceRule::contact : PlaceRule::bottom_left;
    Layout layout = pack_first_fit(problem_, candidate, rule);
    if (best_.better_than(layout)) return;
    best_ = std::move(layout);
    order_ = std::move(candidate);
  }

 private:
  const Problem& problem_;
  Random random_;
  std::vector<std::uint32_t> order_;
  Layout best_;
};

}  // namespace

Layout search_first_fit(const Problem& problem, const SearchLimits& limits, const Context& context,
                        PackResult& result) {
  const double begun = wall_seconds();
  double longest = 0;  // seconds of the longest layout so far; the next may take as long
  // Whether only items of falling heights were packed, which is ten times as fast.
  bool falling = true;
  const auto late = [&] {
    const double next = falling ? 10 * longest : longest;
    return context.cancelled() || wall_seconds() - begun + next > limits.seconds;
  };
  std::vector<std::uint32_t> start;
  Layout best;
  for (Order order : {Order::height, Order::area, Order::max_side}) {
    if (!start.empty() && late()) return best;
    const double before = wall_seconds();
    std::vector<std::uint32_t> ids = sorted_items(problem.items, order);
    Layout layout = pack_first_fit(problem, ids, PlaceRule::bottom_left);
    longest = std::max(longest, wall_seconds() - before);
    falling = order == Order::height && !problem.allow_rotation;
    ++result.layouts_tried;
    if (!start.empty() && !layout.better_than(best)) continue;
    start = std::move(ids);
    best = std::move(layout);
  }
  if (limits.layouts == 1 || late()) return best;
  std::vector<OrderChain> chains;
  for (std::uint32_t c = 0; c < limits.chains; ++c) {
    chains.emplace_back(problem, limits.seed * 0x10001 + c);
    chains.back().start(start, best);
  }
  SearchLimits left = limits;
  left.seconds -= wall_seconds() - begun;
  return chains[run_chains(chains, left, context, result)].best();
}

}  // namespace atlas::pack
