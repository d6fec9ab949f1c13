#include "libatlas/pack/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "libatlas/core/is_enumerator.h"
#include "libatlas/pack/fitting/fit_at_scale.h"
#include "libatlas/pack/fitting/fit_pages.h"
#include "libatlas/pack/fitting/lost_room.h"
#include "libatlas/pack/outlines/chart_outline.h"
#include "libatlas/pack/outlines/shape_check.h"
#include "libatlas/pack/pressing/specks.h"

namespace atlas {
namespace pack {

bool group_areas(std::span<const std::uint64_t> areas, std::uint32_t pages, const Context& context,
                 GroupingResult& grouping) {
  GroupingOptions options;
  options.groups = pages;
  options.refine_work = 0;
  Result<GroupingResult> found = group_sizes(areas, options, context);
  if (!found.ok()) return false;
  grouping = std::move(*found);
  return true;
}

GroupingResult in_texels(GroupingResult grouping, std::int32_t cell) {
  const auto texels = static_cast<std::uint64_t>(std::int64_t{cell} * cell);
  for (std::uint64_t* area :
       {&grouping.capacity, &grouping.largest_group, &grouping.lower_bound, &grouping.upper_bound})
    *area *= texels;
  for (std::uint64_t& size : grouping.group_size) size *= texels;
  for (GroupingStep& step : grouping.trace) step.capacity *= texels;
  return grouping;
}

std::vector<Extent> smaller_pages(const FitOptions& options) {
  std::vector<Extent> sizes;
  for (std::int32_t s = 1; s <= options.page_size / 2; s *= 2) {
    sizes.push_back({s, s});
    if (!options.square) sizes.push_back({2 * s, s});
  }
  return sizes;
}

}  // namespace pack

namespace {

Status check_pages(const FitOptions& o) {
  if (o.max_packings < 2)
    return {ErrorCode::bad_option,
            fmt::format("fit: max_packings is {} (at least 2)", o.max_packings)};
  if (o.pages == 0) return {ErrorCode::bad_option, "fit: pages is 0 (ask for at least one)"};
  constexpr std::int32_t kLongest = 1 << 20;
  if (o.page_size < 1 || o.page_size > kLongest)
    return {ErrorCode::bad_option,
            fmt::format("fit: page_size is {} (1 .. {})", o.page_size, kLongest)};
  if (o.padding < 0 || o.alignment < 1 || o.minimum_side < 0)
    return {ErrorCode::bad_option,
            fmt::format("fit: padding {}, alignment {}, minimum_side {} (alignment at least 1, the "
                        "others at least 0)",
                        o.padding, o.alignment, o.minimum_side)};
  if (o.alignment > o.page_size || o.padding > (o.page_size - o.alignment) / 2)
    return {ErrorCode::bad_option,
            fmt::format("fit: padding {} on both sides and alignment {} leave no room on pages of "
                        "{} texels (use larger pages)",
                        o.padding, o.alignment, o.page_size)};
  if (!(o.time_budget >= 0))
    return {ErrorCode::bad_option, "fit: time_budget is negative or not a number"};
  if (!is_enumerator(o.preset, PackPreset::best))
    return {ErrorCode::bad_option,
            fmt::format("fit: preset {} (give a PackPreset)", int(o.preset))};
  if (!(o.shapes_area >= 0) || !std::isfinite(o.shapes_area))
    return {ErrorCode::bad_option,
            fmt::format("fit: shapes_area is {} (at least 0)", o.shapes_area)};
  const bool power_of_two = o.power_of_two && !o.free_aspect;
  if (power_of_two && !std::has_single_bit(static_cast<std::uint32_t>(o.page_size)))
    return {ErrorCode::bad_option,
            fmt::format("fit: page_size {} is not a power of two (use {})", o.page_size,
                        std::bit_floor(static_cast<std::uint32_t>(o.page_size)))};
  if (power_of_two && !std::has_single_bit(static_cast<std::uint32_t>(o.alignment)))
    return {ErrorCode::bad_option, "fit: with power-of-two pages the alignment must be one too"};
  return {};
}

Status check(std::span<const FitItem> items, const FitOptions& o) {
  if (Status s = check_pages(o); !s.ok()) return s;
  if (!(o.max_scale > 0) || !std::isfinite(o.max_scale))
    return {ErrorCode::bad_option, "fit: max_scale must be finite and above 0"};
  if (!o.shapes.empty()) {
    if (o.shapes.size() != items.size())
      return {ErrorCode::bad_option, fmt::format("fit: {} shapes for {} items (one each, or none)",
                                                 o.shapes.size(), items.size())};
    if (Status s = pack::check_rotations(o.rotations); !s.ok()) return s;
    if (Status s = pack::check_shapes(o.shapes); !s.ok()) return s;
  }
  for (std::size_t i = 0; i < items.size(); ++i)
    if (!(items[i].width >= 0) || !(items[i].height >= 0) || !std::isfinite(items[i].width) ||
        !std::isfinite(items[i].height))
      return {ErrorCode::bad_input,
              fmt::format("fit: item {} has size {} x {} (sizes must be finite and not negative)",
                          i, items[i].width, items[i].height)};
  return {};
}

// Returns the alignment for outlines. They are laid on cells, whose number grows with the square of
// the page's side: packing a page of 32768 texels took 2.8 GB and a minute. So a side has at most
// kMostCells cells, which rounds each chart's gutter up by at most a ten-thousandth of the side or
// so. The cell is a multiple of the alignment that was asked for.
std::int32_t outline_alignment(const FitOptions& options) {
  constexpr std::int32_t kMostCells = 8192;
  std::int32_t alignment = options.alignment;
  while (options.page_size / alignment > kMostCells) alignment *= 2;
  return alignment;
}

pack::FitSearchOptions for_items(std::size_t items, const pack::FitSearchOptions& given) {
  pack::FitSearchOptions options = given;
  if (options.free_aspect) options.power_of_two = options.square = false;
  options.pages =
      std::min(given.pages, static_cast<std::uint32_t>(std::max<std::size_t>(1, items)));
  if (!options.shapes.empty()) options.alignment = outline_alignment(options);
  options.deadline = ending(options);
  return options;
}

void note_lost_area(std::span<const pack::ChartOutline> outlines, const FitOptions& options,
                    const Context& context, FitResult& fitted) {
  fitted.lost_area = pack::lost_to_holes(outlines) +
                     pack::lost_to_bays(outlines, options.padding / fitted.scale, context);
}

}  // namespace

namespace pack {

Result<FitResult> search_fit(std::span<const FitItem> items, const FitSearchOptions& given,
                             const Context& context) {
  if (Status status = check(items, given); !status.ok()) return status;
  const FitSearchOptions options = for_items(items.size(), given);
  if (items.empty()) {
    FitResult none;
    none.scale = options.max_scale;
    return none;
  }
  if (options.shapes.empty()) return fit_boxes(items, options, context);
  const std::vector<ChartOutline> outlines = outlines_of(options.shapes, context);
  Result<FitResult> fitted = fit_outlines_at_most({items, outlines}, options, context);
  if (fitted.ok()) note_lost_area(outlines, options, context, *fitted);
  if (context.cancelled()) return Status::cancelled();
  return fitted;
}

Result<FitResult> press_fit(FitResult fitted, std::span<const FitItem> items,
                            const FitSearchOptions& given, const Context& context) {
  const FitSearchOptions options = for_items(items.size(), given);
  const std::vector<ChartOutline> outlines = outlines_of(options.shapes, context);
  std::optional<FitResult> denser = press_pages(fitted, {items, outlines}, options, context);
  if (denser) note_lost_area(outlines, options, context, *denser);
  if (context.cancelled()) return Status::cancelled();
  return denser ? std::move(*denser) : std::move(fitted);
}

}  // namespace pack

Result<FitResult> fit_pages(std::span<const FitItem> items, const FitOptions& options,
                            const Context& context) {
  return pack::search_fit(items, {options}, context);
}

}  // namespace atlas
