#include "libatlas/pack/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "libatlas/pack/engines.h"
#include "libatlas/pack/fit_pages.h"
#include "libatlas/pack/fit_result.h"
#include "libatlas/pack/shape_check.h"

namespace atlas {
namespace pack {
namespace {

std::int32_t content_side(double extent, double scale, std::int32_t minimum) {
  const double least = std::min<double>(minimum, std::ceil(extent));
  // The small slack keeps 100 texels at scale 0.5 from becoming 51 by rounding error.
  const double side = std::ceil(extent * scale * (1 - 1e-12));
  return static_cast<std::int32_t>(std::clamp(side, std::max(least, 1.0), 1e9));
}

std::int32_t cells(std::int32_t content, const FitOptions& options) {
  const std::int64_t side = std::int64_t{content} + 2 * std::int64_t{options.padding};
  return static_cast<std::int32_t>((side + options.alignment - 1) / options.alignment);
}

}  // namespace

BoxFit::BoxFit(std::span<const FitItem> items, const FitOptions& options, const Context& context)
    : items_(items), options_(options), context_(context) {
  const std::int32_t side = options.page_size / options.alignment;
  page_ = {side, side};
}

void BoxFit::make_boxes(double scale) {
  contents_.resize(items_.size());
  boxes_.resize(items_.size());
  for (std::size_t i = 0; i < items_.size(); ++i) {
    contents_[i] = {content_side(items_[i].width, scale, options_.minimum_side),
                    content_side(items_[i].height, scale, options_.minimum_side)};
    boxes_[i] = {cells(contents_[i].width, options_), cells(contents_[i].height, options_)};
  }
}

double BoxFit::box_area(double scale) {
  make_boxes(scale);
  double area = 0;
  for (const Extent& b : boxes_) area += static_cast<double>(b.area());
  return area;
}

bool BoxFit::box_fits_page(const Extent& box) const {
  return box.width <= page_.width && box.height <= page_.height;
}

// Whether every single box fits the page and all together do not exceed the pages' area.
bool BoxFit::may_fit(double scale) {
  const double area = box_area(scale);
  for (const Extent& b : boxes_)
    if (!box_fits_page(b)) return false;
  return area <= static_cast<double>(page_.area()) * options_.pages;
}

double BoxFit::least_scale() const {
  double least = options_.max_scale;
  for (const FitItem& item : items_)
    for (const double extent : {item.width, item.height})
      if (extent > 0)
        least = std::min(least, content_side(extent, 0, options_.minimum_side) / extent);
  return least;
}

bool BoxFit::pack_at(double scale, std::uint32_t pages, BoxLayout& layout) {
  make_boxes(scale);
  for (const Extent& b : boxes_)
    if (!box_fits_page(b)) return false;
  if (!group(pages, layout)) return false;
  if (pages == 1 && boxes_.size() >= kManyItems) return pack_many(layout);
  return pack_grouped(pages, layout) || pack_jointly(pages, layout) || pack_searched(pages, layout);
}

// Many items leave no gap of a single page empty, whatever the method: the fastest is taken.
bool BoxFit::pack_many(BoxLayout& layout) const {
  Problem problem;
  problem.items = boxes_;
  problem.page = page_;
  problem.allow_rotation = options_.allow_rotation;
  problem.context = &context_;
  problem.max_pages = 1;
  Layout packed = pack_widest_first(problem);
  if (packed.unplaced > 0) return false;
  layout.placements = std::move(packed.placements);
  layout.pages = 1;
  layout.moved = 0;
  return true;
}

bool BoxFit::group(std::uint32_t pages, BoxLayout& layout) const {
  std::vector<std::uint64_t> areas(boxes_.size());
  for (std::size_t i = 0; i < areas.size(); ++i)
    areas[i] = static_cast<std::uint64_t>(boxes_[i].area());
  return group_areas(areas, pages, context_, layout.grouping);
}

// Each group into its own page, largest items first; what is left over goes wherever it fits.
bool BoxFit::pack_grouped(std::uint32_t pages, BoxLayout& layout) {
  layout.moved = 0;
  layout.placements.assign(boxes_.size(), {});
  std::vector<FreeRects> open(pages, FreeRects(page_));
  std::vector<std::uint32_t> left;
  for (std::uint32_t item : sorted_items(boxes_, Order::height)) {
    const std::uint32_t group = layout.grouping.group[item];
    if (!place(item, group, open[group], layout)) left.push_back(item);
  }
  for (std::uint32_t item : left) {
    bool placed = false;
    for (std::uint32_t p = 0; p < pages && !placed; ++p) placed = place(item, p, open[p], layout);
    if (!placed) return false;
    ++layout.moved;
  }
  layout.pages = pages;
  return true;
}

bool BoxFit::place(std::uint32_t item, std::uint32_t page, FreeRects& free,
                   BoxLayout& layout) const {
  Spot spot;
  if (!free.find(boxes_[item], options_.allow_rotation, PlaceRule::bottom_left, spot)) return false;
  free.place(spot.rect);
  layout.placements[item] = {page, spot.rect.x, spot.rect.y, spot.rotated};
  return true;
}

// First fit over all pages at once: denser than groups when the pages are nearly full, since the
// small items of all groups fill the gaps of every page.
bool BoxFit::pack_jointly(std::uint32_t pages, BoxLayout& layout) {
  Problem problem;
  problem.items = boxes_;
  problem.page = page_;
  problem.allow_rotation = options_.allow_rotation;
  problem.context = &context_;
  problem.max_pages = pages;
  const bool fast = options_.preset == PackPreset::fast;
  for (Order order : {Order::area, Order::height}) {
    if (keep(pack_gaps(problem, sorted_items(boxes_, order)), layout)) return true;
    if (fast) break;
  }
  for (Order order : {Order::height, Order::max_side, Order::area}) {
    if (keep(pack_first_fit(problem, sorted_items(boxes_, order), PlaceRule::bottom_left), layout))
      return true;
    if (fast) break;
  }
  return false;
}

// By local search, where the items are few enough for it: 1 to 4 % larger scales on pages of a
// dozen boxes, for a hundredth of a second.
bool BoxFit::pack_searched(std::uint32_t pages, BoxLayout& layout) {
  if (options_.preset == PackPreset::fast || boxes_.size() >= kManyItems) return false;
  Problem problem;
  problem.items = boxes_;
  problem.page = page_;
  problem.allow_rotation = options_.allow_rotation;
  problem.context = &context_;
  SearchLimits limits = standard_page_limits(boxes_.size());
  limits.enough_pages = pages;
  PackResult log;
  Layout found = search_pages(problem, limits, context_, log);
  return found.pages <= pages && keep(std::move(found), layout);
}

// Makes a layout of all boxes that of the fit; false if it lacks any.
bool BoxFit::keep(Layout found, BoxLayout& layout) const {
  if (found.unplaced > 0) return false;
  layout.moved = 0;
  for (std::size_t i = 0; i < boxes_.size(); ++i)
    layout.moved += found.placements[i].page != layout.grouping.group[i];
  layout.placements = std::move(found.placements);
  layout.pages = found.pages;
  return true;
}

// Packs the items of one page again into the smallest page size that holds them.
Extent BoxFit::shrink_page(std::uint32_t page, BoxLayout& layout) const {
  std::vector<std::uint32_t> members;
  std::vector<Extent> sizes;
  std::int64_t area = 0;
  for (std::uint32_t i = 0; i < boxes_.size(); ++i)
    if (layout.placements[i].page == page) {
      members.push_back(i);
      sizes.push_back(boxes_[i]);
      area += boxes_[i].area();
    }
  for (const Extent& texels : smaller_pages(options_)) {
    const Extent size{texels.width / options_.alignment, texels.height / options_.alignment};
    if (size.area() < area) continue;
    Problem problem;
    problem.items = sizes;
    problem.page = size;
    problem.allow_rotation = options_.allow_rotation;
    problem.context = &context_;
    problem.max_pages = 1;
    const Layout packed =
        pack_first_fit(problem, sorted_items(sizes, Order::height), PlaceRule::bottom_left);
    if (packed.unplaced > 0) continue;
    for (std::size_t k = 0; k < members.size(); ++k) {
      layout.placements[members[k]] = packed.placements[k];
      layout.placements[members[k]].page = page;
    }
    return size;
  }
  return page_;
}

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

double scale_tolerance(const FitOptions& options, double exact, std::size_t items) {
  return options.free_aspect && items >= kManyItems ? 0.02 : exact;
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

using pack::BoxFit;
using pack::BoxLayout;

Status check(std::span<const FitItem> items, const FitOptions& o) {
  if (o.max_packings < 2)
    return {ErrorCode::bad_option,
            fmt::format("fit: max_packings is {} (at least 2)", o.max_packings)};
  if (o.pages == 0) return {ErrorCode::bad_option, "fit: pages is 0 (ask for at least one)"};
  if (o.alignment < 1 || o.padding < 0 || o.page_size < o.alignment + 2 * o.padding ||
      o.page_size > (1 << 20) || o.minimum_side < 0)
    return {
        ErrorCode::bad_option,
        fmt::format("fit: page_size {}, padding {}, alignment {} and minimum_side {} do not go "
                    "together (page_size in [alignment + 2 padding, 2^20], others not negative)",
                    o.page_size, o.padding, o.alignment, o.minimum_side)};
  if (o.power_of_two && !std::has_single_bit(static_cast<std::uint32_t>(o.page_size)))
    return {ErrorCode::bad_option,
            fmt::format("fit: page_size {} is not a power of two (use {})", o.page_size,
                        std::bit_floor(static_cast<std::uint32_t>(o.page_size)))};
  if (o.power_of_two && !std::has_single_bit(static_cast<std::uint32_t>(o.alignment)))
    return {ErrorCode::bad_option, "fit: with power-of-two pages the alignment must be one too"};
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

// Outlines are laid on cells, whose number grows with the square of the page's side: one of 32768
// texels took 2.8 GB and a minute. Cells of which so many make a side lose a ten-thousandth of it
// around each chart; they are multiples of what was asked for.
std::int32_t outline_alignment(const FitOptions& options) {
  constexpr std::int32_t kMostCells = 8192;
  std::int32_t alignment = options.alignment;
  while (options.page_size / alignment > kMostCells) alignment *= 2;
  return alignment;
}

// The largest scale that was seen to fit, by bisection; the layout of that scale. Each packing
// halves the interval on average; with 12 of them the scale is within 0.1 % of the threshold.
bool search_scale(BoxFit& fit, FitResult& result, BoxLayout& best) {
  const FitOptions& options = fit.options();
  const Context& context = fit.context();
  const auto attempt = [&](double scale) {
    BoxLayout layout;
    ++result.packings;
    const bool ok = fit.pack_at(scale, options.pages, layout);
    result.trace.emplace_back(scale, ok);
    if (ok) {
      best = std::move(layout);
      result.scale = scale;
    }
    context.report("pack", std::min(1.0, double(result.packings) / options.max_packings));
    return ok;
  };
  if (fit.may_fit(options.max_scale) && attempt(options.max_scale)) return true;
  if (!fit.may_fit(fit.least_scale())) return false;
  double high = options.max_scale, low = 0;
  while (high - low > 1e-4 * high) {  // by area and single boxes: cheap
    const double middle = (low + high) / 2;
    (fit.may_fit(middle) ? low : high) = middle;
  }
  // Packings reach 90 to 98 % of the area, so a step below the area bound is likely to fit.
  bool found = false;
  const double first = low * 0.97;
  double step = first;
  low = 0;
  while (result.packings + 1 < options.max_packings && high > 0) {
    if (context.cancelled()) return false;
    const bool ok = attempt(step);
    (ok ? low : high) = step;
    found = found || ok;
    if (found && high - low < 5e-4 * high) break;
    if (!found && step < 1e-9 * first) break;
    step = found ? (low + high) / 2 : step * 0.85;
  }
  return found || attempt(fit.least_scale());
}

void finish(const BoxFit& fit, const FitOptions& options, BoxLayout& layout, FitResult& result) {
  const std::int32_t a = options.alignment;
  result.pages.assign(layout.pages, {options.page_size, options.page_size});
  for (std::uint32_t p = 0; p < layout.pages; ++p) {
    if (options.power_of_two) {
      const Extent cells = fit.shrink_page(p, layout);
      if (!(cells == fit.page())) result.pages[p] = {cells.width * a, cells.height * a};
    } else {
      result.pages[p] = {0, 0};
    }
  }
  result.placements.resize(layout.placements.size());
  double content = 0, boxes = 0;
  for (std::size_t i = 0; i < result.placements.size(); ++i) {
    const Placement& at = layout.placements[i];
    Extent box = fit.boxes()[i];
    if (at.rotated) std::swap(box.width, box.height);
    FitPlacement& out = result.placements[i];
    out.page = at.page;
    out.box = {at.x * a, at.y * a, box.width * a, box.height * a};
    out.content_width = fit.contents()[i].width;
    out.content_height = fit.contents()[i].height;
    out.rotated = at.rotated;
    out.angle = at.rotated ? std::acos(0.0) : 0;
    out.scale = result.scale;
    content += static_cast<double>(fit.contents()[i].area());
    boxes += static_cast<double>(out.box.area());
    if (!options.power_of_two) pack::enclose(out.box, options, result.pages[at.page]);
  }
  pack::drop_empty_pages(result);
  result.utilization = pack::share_of_pages(content, result);
  result.box_utilization = pack::share_of_pages(boxes, result);
  result.moved_items = layout.moved;
  result.grouping = std::move(layout.grouping);
}

}  // namespace

Result<FitResult> fit_pages(std::span<const FitItem> items, const FitOptions& given,
                            const Context& context) {
  if (Status status = check(items, given); !status.ok()) return status;
  FitOptions options = given;
  if (options.free_aspect) options.power_of_two = options.square = false;
  options.pages =
      std::min(given.pages, static_cast<std::uint32_t>(std::max<std::size_t>(1, items.size())));
  FitResult result;
  result.scale = options.max_scale;
  if (items.empty()) return result;
  if (!options.shapes.empty()) {
    options.alignment = outline_alignment(options);
    const std::vector<pack::ChartOutline> outlines = pack::outlines_of(options.shapes, context);
    Result<FitResult> fitted = pack::fit_outlines(items, outlines, options, context);
    if (fitted.ok()) fitted->hole_area = pack::lost_to_holes(outlines);
    return fitted;
  }
  BoxFit fit(items, options, context);
  BoxLayout best;
  const bool found = search_scale(fit, result, best);
  if (context.cancelled()) return Status::cancelled();
  if (!found) return pack::no_room(items.size(), options);
  // With everything at its largest scale, fewer pages may do.
  if (result.scale == options.max_scale) {
    const double pages = fit.box_area(result.scale) / static_cast<double>(fit.page().area());
    for (auto n = static_cast<std::uint32_t>(std::max(1.0, std::ceil(pages)));
         n < best.pages && result.packings < options.max_packings; ++n) {
      BoxLayout fewer;
      ++result.packings;
      if (!fit.pack_at(result.scale, n, fewer)) continue;
      best = std::move(fewer);
      break;
    }
  }
  fit.make_boxes(result.scale);
  finish(fit, options, best, result);
  if (context.cancelled()) return Status::cancelled();  // pages may be larger than they need be
  return result;
}

}  // namespace atlas
