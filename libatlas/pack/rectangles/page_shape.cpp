#include "libatlas/pack/rectangles/page_shape.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "libatlas/pack/rectangles/page_strips.h"
#include "libatlas/pack/rectangles/pull_in.h"

namespace atlas::pack {
namespace {

constexpr std::int32_t kLongestSide = 1 << 30;

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

// Enlarges `used`, the texels that are used of a page, so that it holds an item and the border.
void enclose(const Placement& at, Extent item, const PackOptions& options, Extent& used) {
  const AlignedCells cells(options);
  if (at.rotated) std::swap(item.width, item.height);
  used = {std::max(used.width, cells.texel(at.x) + item.width + options.border),
          std::max(used.height, cells.texel(at.y) + item.height + options.border)};
}

// Returns the part of its page, in texels, that a layout of one page uses.
Extent used_page(const Problem& problem, const Layout& layout, const PackOptions& options) {
  Extent used;
  for (std::size_t i = 0; i < problem.items.size(); ++i)
    if (layout.placements[i].placed())
      enclose(layout.placements[i], problem.texels[i], options, used);
  return used;
}

// Leaves only this share of the effort of `best`.
void share_effort(double share, PackOptions& options) {
  if (options.preset != PackPreset::best) return;
  options.time_budget *= share;
  if (options.effort == 0) return;
  const double effort = share * static_cast<double>(options.effort);
  options.effort = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(effort));
}

}  // namespace

Extent shaped_page(Extent used, const PackOptions& options) {
  Extent page = options.page;
  // Blocks of a compressed texture are whole ones, also at the page's far edges.
  const auto aligned = [&](std::int32_t side, std::int32_t limit) {
    const std::int64_t blocks = (std::int64_t{side} + options.alignment - 1) / options.alignment;
    const std::int64_t whole = blocks * options.alignment;
    return whole <= (limit > 0 ? limit : kLongestSide) ? static_cast<std::int32_t>(whole) : side;
  };
  // Items without area use nothing, but an image has a texel at least.
  used = {std::max(1, used.width), std::max(1, used.height)};
  if (options.page.height == 0 || options.crop)
    page.height = aligned(used.height, options.page.height);
  if (options.page.width == 0 || options.crop) page.width = aligned(used.width, options.page.width);
  const auto round_up = [](std::int32_t v) {
    return static_cast<std::int32_t>(std::bit_ceil(static_cast<std::uint32_t>(v)));
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
    if (options_.crop && layout.pages > 1 && !context_.cancelled()) reshape_last_page(layout);
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
    PackOptions most = options_;
    share_effort(1 - kForLastPage, most);
    return solve_with(most);
  }

  // The last page is the emptiest, and the engines give it the shape of a strip on the largest
  // page. Its items get the smallest page that items of a single page would get.
  void reshape_last_page(Layout& layout) {
    std::vector<std::uint32_t> ids;
    std::vector<Extent> items, texels;
    Layout last;
    last.pages = 1;
    for (std::uint32_t i = 0; i < layout.placements.size(); ++i) {
      Placement at = layout.placements[i];
      if (!at.placed() || at.page + 1 != layout.pages) continue;
      at.page = 0;
      ids.push_back(i);
      items.push_back(problem_.items[i]);
      texels.push_back(problem_.texels[i]);
      last.placements.push_back(at);
    }
    if (ids.empty()) return;
    Problem alone = problem_;
    alone.items = items;
    alone.texels = texels;
    alone.max_pages = 1;
    PackOptions options = options_;
    share_effort(kForLastPage, options);
    const std::uint32_t bound = result_.page_lower_bound;
    ShapeSolver solver(alone, options, context_, result_);
    if (Layout anew = solver.run(); solver.cost(anew) < solver.cost(last)) last = std::move(anew);
    result_.page_lower_bound = bound;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      layout.placements[ids[k]] = last.placements[k];
      layout.placements[ids[k]].page = layout.pages - 1;
    }
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
    const StripProblem tried(problem_, strip,
                             AlignedCells(options_).page((1 << 30) - options_.padding));
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
    if (options_.preset == PackPreset::best && options_.effort > 0)
      count = std::min<std::size_t>(count, options_.effort / (4 * kOrders));
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
    share_effort(1 / static_cast<double>(strips.size()), share);
    for (const Strip strip : strips)
      offer(pack_strip(
          strip, [&](const Problem& tried) { return solve(tried, share, context_, result_); }));
    return best;
  }

  // The share of the effort of `best` that is spent on the last of several pages.
  static constexpr double kForLastPage = 0.2;

  const Problem& problem_;
  const PackOptions& options_;
  const Context& context_;
  PackResult& result_;
};

// Returns the texels of all pages as they are reported.
double page_texels(const Problem& problem, const Layout& layout, const PackOptions& options) {
  std::vector<Extent> used(layout.pages);
  for (std::size_t i = 0; i < problem.items.size(); ++i)
    if (const Placement& at = layout.placements[i]; at.placed())
      enclose(at, problem.texels[i], options, used[at.page]);
  double texels = 0;
  for (const Extent& page : used) texels += static_cast<double>(shaped_page(page, options).area());
  return texels;
}

// Layouts with smaller costs are better: those of fewer unplaced items, then of fewer pages, then
// of smaller ones.
std::tuple<std::uint32_t, std::uint32_t, double> shape_cost(const Problem& problem,
                                                            const Layout& layout,
                                                            const PackOptions& options) {
  return {layout.unplaced, layout.pages, page_texels(problem, layout, options)};
}

// Whether pages get the shape that their items need, and packing them a second time takes no
// seconds. Strips whose width is given are made low instead.
bool is_shaped(const Problem& problem, const PackOptions& options) {
  constexpr std::size_t kMany = 50'000;
  const bool strip = options.page.width != 0 && options.page.height == 0;
  const bool shaped = options.page.width == 0 || options.crop;
  return shaped && !strip && problem.pinned.empty() && problem.items.size() <= kMany;
}

// Whether the items are worth packing as `fast` does, too. The searches make pages few or strips
// low, and what they find is not always what can be cropped best.
bool worth_fast(const Problem& problem, const PackOptions& options) {
  return is_shaped(problem, options) && options.preset != PackPreset::fast &&
         options.engine == PackEngine::automatic;
}

// Whether a page of this shape is worth packing without turns as well. Strips whose width is given
// do that by themselves.
bool worth_unturned(const Problem& problem, const PackOptions& options) {
  if (!problem.allow_rotation || !is_shaped(problem, options)) return false;
  return std::all_of(problem.items.begin(), problem.items.end(), [&](const Extent& e) {
    return e.width <= problem.page.width && e.height <= problem.page.height;
  });
}

// Solves the problem with turns and, where that is worth it, without them.
Layout solve_turns(const Problem& problem, const PackOptions& options, const Context& context,
                   PackResult& result) {
  if (!worth_unturned(problem, options))
    return ShapeSolver(problem, options, context, result).run();
  constexpr double kUnturned = 0.25;  // the share of the effort of `best`
  Problem part = problem;
  PackOptions share = options;
  part.allow_rotation = false;
  share_effort(kUnturned, share);
  Layout unturned = ShapeSolver(part, share, context, result).run();
  part = problem;
  part.search_unturned = false;
  share = options;
  share_effort(1 - kUnturned, share);
  Layout turned = ShapeSolver(part, share, context, result).run();
  const bool unturned_wins =
      shape_cost(problem, unturned, options) < shape_cost(problem, turned, options);
  return unturned_wins ? std::move(unturned) : std::move(turned);
}

}  // namespace

Layout solve_shape(const Problem& problem, const PackOptions& options, const Context& context,
                   PackResult& result) {
  Layout best = solve_turns(problem, options, context, result);
  if (!worth_fast(problem, options) || context.cancelled()) return best;
  PackOptions fast = options;
  fast.preset = PackPreset::fast;
  PackResult log;
  Layout quick = solve_turns(problem, fast, context, log);
  result.layouts_tried += log.layouts_tried;
  const bool quick_wins = shape_cost(problem, quick, options) < shape_cost(problem, best, options);
  return quick_wins ? std::move(quick) : std::move(best);
}

}  // namespace atlas::pack
