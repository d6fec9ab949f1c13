#include "libatlas/pack/pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/pack/rectangles/cells.h"
#include "libatlas/pack/rectangles/page_shape.h"

namespace atlas {
namespace {

using pack::AlignedCells;
using pack::Layout;
using pack::Problem;

// Maximum side of a page in texels, with the padding that its cells extend beyond it. Sums of two
// sides stay within 32 bits.
constexpr std::int32_t kLongestSide = 1 << 30;

// Returns the number of cells along an open side: as many as the longest page has.
std::int32_t open_side(const PackOptions& options, const AlignedCells& cells) {
  return cells.page(kLongestSide - options.padding);
}

Status check(std::span<const Extent> items, const PackOptions& o) {
  const auto bad = [](std::string text) { return Status(ErrorCode::bad_option, std::move(text)); };
  if (o.padding < 0 || o.border < 0 || o.alignment < 1 || o.padding > (1 << 24) ||
      o.border > (1 << 24) || o.alignment > (1 << 24))
    return bad(
        fmt::format("pack: padding {}, border {}, alignment {} (padding and border in 0 .. "
                    "2^24, alignment in 1 .. 2^24)",
                    o.padding, o.border, o.alignment));
  const std::int32_t longest = kLongestSide - o.padding;
  if (o.page.width < 0 || o.page.height < 0 || o.page.width > longest || o.page.height > longest ||
      (o.page.width == 0 && o.page.height != 0))
    return bad(
        fmt::format("pack: page {} x {} with padding {} (sides in 1 .. 2^30 - padding; height "
                    "0 for a strip, both 0 for a free page)",
                    o.page.width, o.page.height, o.padding));
  const auto power = [](std::int32_t v) {
    return v == 0 || std::has_single_bit(static_cast<std::uint32_t>(v));
  };
  if (o.power_of_two && (!power(o.page.width) || !power(o.page.height)))
    return bad(fmt::format("pack: page {} x {} is no power of two (use {} x {})", o.page.width,
                           o.page.height, std::bit_floor(static_cast<std::uint32_t>(o.page.width)),
                           std::bit_floor(static_cast<std::uint32_t>(o.page.height))));
  if (o.square && o.page.height != 0 && o.page.width != o.page.height)
    return bad(fmt::format("pack: square pages asked for, but the page is {} x {}", o.page.width,
                           o.page.height));
  if (!(o.time_budget >= 0)) return bad("pack: time_budget is negative or not a number");
  if (!is_enumerator(o.preset, PackPreset::best) || !is_enumerator(o.engine, PackEngine::max_rects))
    return bad(fmt::format("pack: preset {}, engine {} (give a PackPreset and a PackEngine)",
                           int(o.preset), int(o.engine)));
  for (std::size_t i = 0; i < items.size(); ++i)
    if (items[i].width < 0 || items[i].height < 0)
      return {ErrorCode::bad_input, fmt::format("pack: item {} is {} x {} (sides must not be "
                                                "negative)",
                                                i, items[i].width, items[i].height)};
  return {};
}

// The items that the engines are given, in cells, and their ids.
struct Active {
  std::vector<Extent> sizes, texels;
  std::vector<std::uint32_t> ids;
};

Active select_items(std::span<const Extent> items, const AlignedCells& cells,
                    const PackOptions& options, PackResult& result) {
  Active active;
  const std::int32_t width =
      options.page.width > 0 ? cells.page(options.page.width) : open_side(options, cells);
  const std::int32_t height =
      options.page.height > 0 ? cells.page(options.page.height) : open_side(options, cells);
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    if ((items[i].width == 0 || items[i].height == 0) && cells.has_corner(options.page)) {
      result.placements[i] = {0, cells.corner(), cells.corner(), false};
      continue;
    }
    const std::int64_t w = cells.item(items[i].width), h = cells.item(items[i].height);
    const bool area = items[i].area() > 0;
    const bool fits = area && w <= width && h <= height;
    const bool fits_turned = area && options.allow_rotation && h <= width && w <= height;
    if (!fits && !fits_turned) {
      result.unplaced.push_back({i, UnplacedReason::too_large});
      continue;
    }
    active.sizes.push_back({static_cast<std::int32_t>(w), static_cast<std::int32_t>(h)});
    active.texels.push_back(items[i]);
    active.ids.push_back(i);
  }
  return active;
}

// Checks that sums of areas, of items or of filled pages, stay below kMost.
Status check_area(std::span<const Extent> items, const Active& active) {
  constexpr double kMost = 0x1p62;
  double cells = 0, texels = 0;
  for (std::size_t k = 0; k < active.ids.size(); ++k) {
    cells += static_cast<double>(active.sizes[k].area());
    texels += static_cast<double>(items[active.ids[k]].area());
  }
  if (std::max(cells, texels) <= kMost) return {};
  return {ErrorCode::bad_input,
          fmt::format("pack: {} items of {:.3g} texels^2, {:.3g} cells with their padding (at most "
                      "2^62 each: pack them in parts, or in larger units)",
                      active.ids.size(), texels, cells)};
}

void describe(std::span<const Extent> items, const PackOptions& options, PackResult& result) {
  std::uint32_t pages = 0;
  for (const Placement& p : result.placements)
    if (p.placed()) pages = std::max(pages, p.page + 1);
  std::vector<Extent> used(pages);
  std::vector<double> area(pages), filled(pages);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Placement& p = result.placements[i];
    if (!p.placed()) continue;
    Extent e = p.rotated ? Extent{items[i].height, items[i].width} : items[i];
    if (e.area() == 0) e = {};
    used[p.page].width = std::max(used[p.page].width, p.x + e.width + options.border);
    used[p.page].height = std::max(used[p.page].height, p.y + e.height + options.border);
    filled[p.page] += static_cast<double>(e.area());
    result.placed_area += e.area();
  }
  double total = 0, total_without = 0, filled_without = 0;
  for (std::uint32_t p = 0; p < pages; ++p) {
    result.pages.push_back(pack::shaped_page(used[p], options));
    area[p] = static_cast<double>(result.pages[p].area());
    total += area[p];
    if (p + 1 < pages) total_without += area[p], filled_without += filled[p];
  }
  result.utilization = total > 0 ? static_cast<double>(result.placed_area) / total : 0;
  result.fill_without_last = total_without > 0 ? filled_without / total_without : 1;
}

}  // namespace

Result<PackResult> pack_rects(std::span<const Extent> items, const PackOptions& options,
                              const Context& context) {
  if (Status status = check(items, options); !status.ok()) return status;
  PackResult result;
  result.placements.resize(items.size());
  const AlignedCells cells(options);
  const Active active = select_items(items, cells, options, result);
  if (Status status = check_area(items, active); !status.ok()) return status;

  Problem problem;
  problem.items = active.sizes;
  problem.texels = active.texels;
  problem.allow_rotation = options.allow_rotation;
  problem.context = &context;
  const std::int32_t open = open_side(options, cells);
  problem.page = {
      options.page.width > 0 ? cells.page(options.page.width) : pack::square_width(problem, open),
      options.page.height > 0 ? cells.page(options.page.height) : open};
  problem.max_pages = options.page.height == 0 ? 1
                      : options.max_pages      ? options.max_pages
                                               : kNoPage;
  for (const PinnedRect& pin : options.pinned) {
    if (pin.page >= (1u << 20) || pin.rect.width < 0 || pin.rect.height < 0)
      return Status(ErrorCode::bad_option,
                    "pack: a pinned rectangle has a negative side or lies on "
                    "a page beyond 2^20");
    const Rect taken = cells.pinned(pin.rect, problem.page);
    if (pin.page >= problem.pinned.size()) problem.pinned.resize(pin.page + 1);
    if (taken.area() > 0) problem.pinned[pin.page].push_back(taken);
  }

  const Layout layout =
      active.sizes.empty() ? Layout{} : pack::solve_shape(problem, options, context, result);
  if (context.cancelled()) return Status::cancelled();
  for (std::size_t k = 0; k < active.ids.size(); ++k) {
    const Placement& p = layout.placements[k];
    if (!p.placed())
      result.unplaced.push_back({active.ids[k], UnplacedReason::no_room});
    else
      result.placements[active.ids[k]] = {p.page, cells.texel(p.x), cells.texel(p.y), p.rotated};
  }
  sort_total(result.unplaced.begin(), result.unplaced.end(),
             [](const UnplacedItem& a, const UnplacedItem& b) { return a.item < b.item; });
  describe(items, options, result);
  return result;
}

}  // namespace atlas
