#include "libatlas/pack/page_shape.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace atlas::pack {
namespace {

double total_area(const Problem& problem) {
  double area = 0;
  for (const Extent& e : problem.items) area += static_cast<double>(e.area());
  return area;
}

std::int32_t widest_item(const Problem& problem) {
  std::int32_t widest = 1;
  for (const Extent& e : problem.items)
    widest = std::max(widest, problem.allow_rotation ? std::min(e.width, e.height) : e.width);
  return widest;
}

// Returns the widths to try, around that of the square. If pages are rounded up to powers of two,
// these are the sides that pages can have.
std::vector<std::int32_t> widths_to_try(const Problem& problem, const PackOptions& options) {
  const bool free = options.page.width == 0;
  const std::int32_t most = free ? problem.page.height : problem.page.width;
  const std::int32_t widest = widest_item(problem);
  const double side = free ? problem.page.width : square_width(problem, most);
  std::vector<std::int32_t> widths;
  if (options.power_of_two) {
    const Cells cells(options);
    for (std::int32_t texels = 1; texels <= (1 << 29); texels *= 2) {
      const std::int32_t width = cells.page(texels);
      if (width >= widest && width <= most && width > 0.35 * side && width < 4.2 * side)
        widths.push_back(width);
    }
    if (!widths.empty()) return widths;
  }
  for (int k = 0; k < 5; ++k) {
    const double width = std::min<double>(side * (0.94 + 0.03 * k), most);
    widths.push_back(std::max(widest, static_cast<std::int32_t>(width)));
  }
  widths.erase(std::unique(widths.begin(), widths.end()), widths.end());
  return widths;
}

// Returns the part of its page, in texels, that a layout uses.
Extent used_page(const Problem& problem, const Layout& layout, const PackOptions& options) {
  Extent used;
  for (std::size_t i = 0; i < problem.items.size(); ++i) {
    const Placement& at = layout.placements[i];
    const Extent e = problem.items[i];
    used.width = std::max(used.width, at.x + (at.rotated ? e.height : e.width));
    used.height = std::max(used.height, at.y + (at.rotated ? e.width : e.height));
  }
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
    const bool fast = options_.preset == PackPreset::fast;
    if (!problem_.pinned.empty()) return solve_with(options_);
    if (options_.page.width == 0 && !fast) return solve_widths({});
    if (!options_.crop || options_.page.height == 0) return solve_with(options_);
    PackOptions quick = options_;
    if (!fast) quick.preset = PackPreset::standard;
    Layout whole = solve_with(quick);
    if (whole.pages == 1 && whole.unplaced == 0) return solve_widths(std::move(whole));
    if (options_.preset == quick.preset) return whole;
    return solve_with(options_);
  }

 private:
  using Cost = std::pair<std::uint32_t, std::int64_t>;  // items that do not fit, the page's area

  Layout solve_with(const PackOptions& options) {
    return solve(problem_, options, context_, result_);
  }

  Cost cost(const Problem& tried, const Layout& layout) const {
    const Extent used = used_page(tried, layout, options_);
    const bool too_high = options_.page.width != 0 && used.height > options_.page.height;
    return {layout.unplaced + too_high, shaped_page(used, options_).area()};
  }

  // Returns the layout with the smallest page over all widths to try, or `best` if none is smaller.
  // `best` may be empty.
  Layout solve_widths(Layout best) {
    const std::vector<std::int32_t> widths = widths_to_try(problem_, options_);
    PackOptions share = options_;
    share.page.height = 0;  // strips
    share.time_budget /= static_cast<double>(widths.size());
    if (options_.effort > 0)
      share.effort = std::max<std::uint64_t>(1, options_.effort / widths.size());
    Cost least{UINT32_MAX, INT64_MAX};
    if (!best.placements.empty()) least = cost(problem_, best);
    std::uint64_t layouts = 0;
    for (const std::int32_t width : widths) {
      Problem tried = problem_;
      tried.page = {width, Cells(options_).page((1 << 30) - options_.padding)};
      tried.max_pages = 1;
      Layout layout = solve(tried, share, context_, result_);
      layouts += result_.layouts_tried;
      const Cost now = cost(tried, layout);
      if (now >= least) continue;
      least = now;
      best = std::move(layout);
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
