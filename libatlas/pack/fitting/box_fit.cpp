#include "libatlas/pack/fitting/box_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libatlas/pack/fitting/fit_pages.h"
#include "libatlas/pack/pressing/specks.h"
#include "libatlas/pack/rectangles/engines.h"

namespace atlas::pack {
namespace {

// This many boxes are packed jointly on several pages, without an attempt by groups.
constexpr std::size_t kVeryMany = 4000;

std::int32_t content_side(double extent, double scale, std::int32_t minimum) {
  const double least = std::min<double>(minimum, std::ceil(extent));
  // The small slack prevents that rounding error turns 100 texels at scale 0.5 into 51.
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

// Returns whether every single box fits the page and all together do not exceed the pages' area.
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
  if (boxes_.size() < kVeryMany && pack_grouped(pages, layout)) return true;
  return pack_jointly(pages, layout) || pack_searched(pages, layout);
}

Problem BoxFit::problem_of(std::span<const Extent> items, Extent page,
                           std::uint32_t max_pages) const {
  Problem problem;
  problem.items = items;
  problem.page = page;
  problem.allow_rotation = options_.allow_rotation;
  problem.context = &context_;
  problem.max_pages = max_pages;
  return problem;
}

// Many items leave no gap of a single page empty, whatever the method is, so the fastest one is
// used.
bool BoxFit::pack_many(BoxLayout& layout) const {
  const Problem problem = problem_of(boxes_, page_, 1);
  Layout packed = pack_widest_first(problem);
  if (packed.unplaced > 0) return false;
  layout.placements = std::move(packed.placements);
  layout.pages = 1;
  return true;
}

bool BoxFit::group(std::uint32_t pages, BoxLayout& layout) const {
  std::vector<std::uint64_t> areas(boxes_.size());
  for (std::size_t i = 0; i < areas.size(); ++i)
    areas[i] = static_cast<std::uint64_t>(boxes_[i].area());
  return group_areas(areas, pages, context_, layout.grouping);
}

// Packs each group into its own page, largest items first. Items that find no room go to any page
// that has some.
bool BoxFit::pack_grouped(std::uint32_t pages, BoxLayout& layout) {
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

// Packs all pages at once, gap after gap. If the pages are nearly full, this is denser than groups,
// since the small items of all groups fill the gaps of every page.
bool BoxFit::pack_jointly(std::uint32_t pages, BoxLayout& layout) {
  const Problem problem = problem_of(boxes_, page_, pages);
  return keep(pack_gaps(problem, sorted_items(boxes_, Order::area)), layout) ||
         keep(pack_gaps(problem, sorted_items(boxes_, Order::height)), layout);
}

// Packs by local search if the items are few enough for it. On pages of a dozen boxes this gives 1
// to 4 % larger scales, and it takes a hundredth of a second.
bool BoxFit::pack_searched(std::uint32_t pages, BoxLayout& layout) {
  if (options_.preset == PackPreset::fast || boxes_.size() >= kManyItems) return false;
  const Problem problem = problem_of(boxes_, page_, kNoPage);
  SearchLimits limits = standard_page_limits(boxes_.size());
  limits.enough_pages = pages;
  PackResult log;
  Layout found = search_pages(problem, limits, context_, log);
  return found.pages <= pages && keep(std::move(found), layout);
}

// Makes `found` the layout of the fit. Returns false if it lacks any box.
bool BoxFit::keep(Layout found, BoxLayout& layout) const {
  if (found.unplaced > 0) return false;
  layout.placements = std::move(found.placements);
  layout.pages = found.pages;
  return true;
}

// Packs the items of one page again into the smallest page size that holds them. Returns that size
// in cells.
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
    const Problem problem = problem_of(sizes, size, 1);
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

}  // namespace atlas::pack
