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

// Returns the layout with the smallest page over all widths to try, or `best` if none is smaller.
// `best` may be empty.
Layout solve_widths(const Problem& problem, const PackOptions& options, const Context& context,
                    PackResult& result, Layout best) {
  const bool free = options.page.width == 0;
  const std::vector<std::int32_t> widths = widths_to_try(problem, options);
  PackOptions share = options;
  share.page.height = 0;  // strips
  share.time_budget /= static_cast<double>(widths.size());
  if (options.effort > 0) share.effort = std::max<std::uint64_t>(1, options.effort / widths.size());
  const auto cost = [&](const Problem& tried, const Layout& layout) {
    const Extent used = used_page(tried, layout, options);
    const bool too_high = !free && used.height > options.page.height;
    return std::pair(layout.unplaced + too_high, shaped_page(used, options).area());
  };
  std::pair least{UINT32_MAX, INT64_MAX};
  if (!best.placements.empty()) least = cost(problem, best);
  std::uint64_t layouts = 0;
  for (const std::int32_t width : widths) {
    Problem tried = problem;
    tried.page = {width, Cells(options).page((1 << 30) - options.padding)};
    tried.max_pages = 1;
    Layout layout = solve(tried, share, context, result);
    layouts += result.layouts_tried;
    const auto now = cost(tried, layout);
    if (now >= least) continue;
    least = now;
    best = std::move(layout);
  }
  result.layouts_tried = layouts;
  return best;
}

}  // namespace

Layout solve_shape(const Problem& problem, const PackOptions& options, const Context& context,
                   PackResult& result) {
  const bool fast = options.preset == PackPreset::fast;
  if (!problem.pinned.empty()) return solve(problem, options, context, result);
  if (options.page.width == 0 && !fast) return solve_widths(problem, options, context, result, {});
  if (!options.crop || options.page.height == 0) return solve(problem, options, context, result);
  PackOptions quick = options;
  if (!fast) quick.preset = PackPreset::standard;
  Layout whole = solve(problem, quick, context, result);
  if (whole.pages == 1 && whole.unplaced == 0)
    return solve_widths(problem, options, context, result, std::move(whole));
  if (options.preset == quick.preset) return whole;
  return solve(problem, options, context, result);
}

}  // namespace atlas::pack
