#include "libatlas/pack/page_shape.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "libatlas/pack/page_strips.h"
#include "libatlas/pack/pull_in.h"

namespace atlas::pack {
namespace {

double total_area(const Problem& problem) {
  double area = 0;
  for (const Extent& e : problem.items) area += static_cast<double>(e.area());
  return area;
}

// Returns the part of its page, in cells, that a layout uses.
Extent used_cells(const Problem& problem, const Layout& layout) {
  Extent used;
  for (std::size_t i = 0; i < problem.items.size(); ++i) {
    const Placement& at = layout.placements[i];
    const Extent e = problem.items[i];
    used.width = std::max(used.width, at.x + (at.rotated ? e.height : e.width));
    used.height = std::max(used.height, at.y + (at.rotated ? e.width : e.height));
  }
  return used;
}

// Returns the same in texels, with the border.
Extent used_page(const Problem& problem, const Layout& layout, const PackOptions& options) {
  const Extent used = used_cells(problem, layout);
  const Cells cells(options);
  const std::int32_t rest = options.border - options.padding;
  return {cells.texel(used.width) + rest, cells.texel(used.height) + rest};
}

}  // namespace

Extent shaped_page(Extent used, const PackOptions& options) {
  Extent page = options.page;
  if (options.page.height == 0 || options.crop) page.height = used.height;
  if (options.page.width == 0 || options.crop) page.width = used.width;
  const auto round_up = [](std::int32_t v) {
    return static_cast<std::int32_t>(std::bit_ceil(static_cast<std::uint32_t>(std::max(1, v))));
  };
  if (options.power_of_two) page = {round_up(page.width), round_up(page.height)};
  if (options.square) page.width = page.height = std::max(page.width, page.height);
  return page;
}

std::int32_t square_width(const Problem& problem, std::int32_t most) {
  std::int32_t widest = 1;
  for (const Extent& e : problem.items) widest = std::max(widest, e.width);
  const double side = std::ceil(std::sqrt(total_area(problem) / 0.95));
  return std::max(widest, static_cast<std::int32_t>(std::min<double>(side, most)));
}

namespace {

class ShapeSolver {
 public:
  ShapeSolver(const Problem& problem, const PackOptions& options, const Context& context,
              PackResult& result)
      : problem_(problem), options_(options), context_(context), result_(result) {}

  Layout run() {
    if (!problem_.pinned.empty()) return solve_with(options_);
    const bool free = options_.page.width == 0;
    if (!free && !options_.crop) return solve_with(options_);
    Layout layout = free ? solve_strips({}) : solve_cropped();
    if (options_.crop) pull_in(problem_, layout);
    return layout;
  }

 private:
  // Items that do not fit, the page's area, and its longer side: of equal pages the squarest is
  // best.
  using Cost = std::tuple<std::uint32_t, std::int64_t, std::int32_t>;

  // A layout and the strip of just its size.
  struct Scanned {
    Cost cost;
    Extent used;  // cells
    Layout layout;
  };

  Layout solve_with(const PackOptions& options) {
    return solve(problem_, options, context_, result_);
  }

  Layout solve_cropped() {
    if (options_.page.height == 0) return solve_with(options_);
    const bool fast = options_.preset == PackPreset::fast;
    PackOptions quick = options_;
    if (!fast) quick.preset = PackPreset::standard;
    Layout whole = solve_with(quick);
    if (whole.pages == 1 && whole.unplaced == 0) return solve_strips(std::move(whole));
    if (options_.preset == quick.preset) return whole;
    return solve_with(options_);
  }

  Cost cost(const Layout& layout) const {
    const Extent used = used_page(problem_, layout, options_);
    const Extent most = options_.page;
    const bool too_large =
        most.width != 0 && (used.width > most.width || used.height > most.height);
    const Extent page = shaped_page(used, options_);
    return {layout.unplaced + too_large, page.area(), std::max(page.width, page.height)};
  }

  // Packs a strip by `pack`, a function from a problem to a layout.
  template <class Pack>
  Layout pack_strip(Strip strip, const Pack& pack) const {
    const StripProblem tried(problem_, strip, Cells(options_).page((1 << 30) - options_.padding));
    Layout layout = pack(tried.problem());
    tried.turn_back(layout);
    pull_in(problem_, layout);
    return layout;
  }

  // Returns how many strips can be scanned without taking long.
  std::size_t strips_to_scan() const {
    constexpr std::size_t kWork = 10'000'000, kMost = 48, kOrders = 5;
    if (options_.engine != PackEngine::automatic) return 0;
    const std::size_t n = problem_.items.size();
    std::size_t count = kWork / (kOrders * n * n + 1);
    if (options_.preset == PackPreset::fast) count /= 10;
    if (options_.effort > 0) count = std::min<std::size_t>(count, options_.effort / (4 * kOrders));
    return std::min(count, kMost);
  }

  // Packs strips of all widths without a search. Few items fit a page much better at some widths
  // than at others. Returns the smallest layouts, the best one first.
  std::vector<Scanned> scan() const {
    constexpr std::size_t kKept = 2;
    std::vector<Scanned> best;
    const std::size_t count = strips_to_scan();
    if (count < 8) return best;
    SearchLimits limits;
    limits.layouts = 1;
    limits.seconds = std::numeric_limits<double>::infinity();
    for (const Strip strip : strips_of_all_widths(problem_, count)) {
      PackResult unused;
      Layout layout = pack_strip(strip, [&](const Problem& tried) {
        return search_strip(tried, limits, context_, unused);
      });
      const Cost now = cost(layout);
      const Extent used = used_cells(problem_, layout);
      const auto same = [&](const Scanned& s) { return s.used == used; };
      if (std::any_of(best.begin(), best.end(), same)) continue;
      const auto after =
          std::find_if(best.begin(), best.end(), [&](const Scanned& s) { return now < s.cost; });
      best.insert(after, {now, used, std::move(layout)});
      if (best.size() > kKept) best.pop_back();
    }
    return best;
  }

  // Returns the layout with the smallest page over all strips to try, or `best` if none is smaller.
  // `best` may be empty.
  Layout solve_strips(Layout best) {
    std::vector<Strip> strips;
    Cost least{UINT32_MAX, INT64_MAX, INT32_MAX};
    const auto offer = [&](Layout layout) {
      const Cost now = cost(layout);
      if (now >= least) return;
      least = now;
      best = std::move(layout);
    };
    if (!best.placements.empty()) least = cost(best);
    for (Scanned& scanned : scan()) {
      // The search may shorten these strips, which are as narrow as the layout.
      add_strip({scanned.used.width, false}, strips);
      add_strip({scanned.used.height, true}, strips);
      offer(std::move(scanned.layout));
    }
    add_usual_strips(problem_, options_, strips);
    PackOptions share = options_;
    share.page.height = 0;  // strips
    share.time_budget /= static_cast<double>(strips.size());
    if (options_.effort > 0)
      share.effort = std::max<std::uint64_t>(1, options_.effort / strips.size());
    std::uint64_t layouts = 0;
    for (const Strip strip : strips) {
      offer(pack_strip(
          strip, [&](const Problem& tried) { return solve(tried, share, context_, result_); }));
      layouts += result_.layouts_tried;
    }
    result_.layouts_tried = layouts;
    return best;
  }

  const Problem& problem_;
  const PackOptions& options_;
  const Context& context_;
  PackResult& result_;
};

}  // namespace

Layout solve_shape(const Problem& problem, const PackOptions& options, const Context& context,
                   PackResult& result) {
  return ShapeSolver(problem, options, context, result).run();
}

}  // namespace atlas::pack
