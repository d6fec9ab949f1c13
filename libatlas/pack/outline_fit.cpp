#include "libatlas/pack/outline_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libatlas/core/parallel.h"
#include "libatlas/pack/fit_factors.h"
#include "libatlas/pack/fit_pages.h"

namespace atlas::pack {

namespace {

// Returns the side that the charts would have on full pages if they were equal squares with the
// same ratio of area to box sides. For needles it is about twice their width.
double mean_side(std::span<const ChartOutline> outlines, const FitOptions& options) {
  constexpr double kFull = 0.75;
  double area = 0, sides = 0;
  for (const ChartOutline& o : outlines) {
    const Vec2d box = box_of(o, 0);
    area += o.area;
    sides += box.x + box.y;
  }
  if (!(sides > 0) || !(area > 0)) return 0;
  const double page = double(options.page_size) * options.page_size * options.pages;
  const double alone = fit_bounds(outlines, options, options.page_size, 4).alone;
  return 2 * area / sides * std::min(std::sqrt(kFull * page / area), alone);
}

}  // namespace

OutlineFit::OutlineFit(std::span<const FitItem> items, std::span<const ChartOutline> outlines,
                       const FitOptions& options, const Context& context)
    : items_(items), outlines_(outlines), options_(options), context_(context) {
  const std::uint32_t rotations =
      options.allow_rotation ? options.rotations : std::min(options.rotations, 1u);
  // A layout takes a tenth of a second per packing and page, much less if there are many charts.
  grid_ = choose_grid({items.size() / options.pages + 1, options.page_size, options.alignment,
                       rotations, options.preset == PackPreset::fast ? 5e6 : 30e6,
                       mean_side(outlines, options)});
  side_ = options.page_size / grid_.cell;
  for (const ChartOutline& o : outlines) area_ += o.area;
}

FitBounds OutlineFit::bounds() const {
  return fit_bounds(outlines_, options_, side_ * grid_.cell, grid_.directions);
}

double OutlineFit::share(double scale) const {
  OutlineLayout layout;
  prepare(scale, layout);
  return double(cells_of(layout.pieces)) / double(cells_of_pages(options_.pages));
}

bool OutlineFit::pack_at(double scale, std::uint32_t pages, OutlineLayout& layout) {
  layout = {};
  layout.scale = scale;
  prepare(scale, layout);
  for (const Piece& p : layout.pieces)
    if (p.too_large) return false;
  if (!group(pages, layout)) return false;
  layout.page = layout.grouping.group;
  if (pages == 1 || scale < groups_fail_at_) {
    if (pack_pages(pages, layout)) return true;
    if (pages == 1) return false;
    groups_fail_at_ = scale;
  }
  deal_out(pages, layout);
  return pack_pages(pages, layout);
}

void OutlineFit::shrink_page(std::uint32_t page, OutlineLayout& layout) const {
  NestPlan plan = plan_by_size(layout.pieces);
  std::erase_if(plan.order, [&](std::uint32_t i) { return layout.page[i] != page; });
  std::int64_t cells = 0;
  for (std::uint32_t i : plan.order) cells += layout.pieces[i].cells();
  for (const Extent& texels : smaller_pages(options_)) {
    const Extent size{texels.width / grid_.cell, texels.height / grid_.cell};
    if (size.area() < cells || size.area() == 0) continue;
    BitPage open(size.width, size.height, longest_run(layout.pieces));
    Nest nest;
    place_pieces(layout.pieces, plan, open, nest);
    if (!nest.left_over.empty()) continue;
    for (std::uint32_t i : plan.order) layout.places[i] = nest.places[i];
    layout.page_sizes[page] = size;
    return;
  }
}

void OutlineFit::prepare(double scale, OutlineLayout& layout) const {
  layout.factors = chart_factors(items_, options_, scale);
  PieceOptions piece_options;
  piece_options.factors = layout.factors;
  piece_options.padding = options_.padding;
  piece_options.cell = grid_.cell;
  piece_options.directions = grid_.directions;
  piece_options.page = {side_, side_};
  layout.pieces = make_pieces(outlines_, piece_options, context_);
}

void OutlineFit::deal_out(std::uint32_t pages, OutlineLayout& layout) const {
  std::vector<std::int64_t> load(pages);
  for (std::uint32_t i : plan_by_size(layout.pieces).order) {
    const auto least = std::min_element(load.begin(), load.end());
    layout.page[i] = static_cast<std::uint32_t>(least - load.begin());
    *least += layout.pieces[i].cells();
  }
}

bool OutlineFit::pack_pages(std::uint32_t pages, OutlineLayout& layout) const {
  std::vector<BitPage> open;
  std::vector<NestSearchResult> found(pages);
  const std::int32_t longest = longest_run(layout.pieces);
  for (std::uint32_t p = 0; p < pages; ++p) open.emplace_back(side_, side_, longest);
  std::vector<std::vector<std::uint32_t>> orders(pages);
  for (const std::uint32_t i : plan_by_size(layout.pieces, by_).order)
    orders[layout.page[i]].push_back(i);
  parallel_for(context_, pages, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      found[p] = fill_group(layout.pieces, orders, p, open[p]);
  });
  if (context_.cancelled()) return false;  // pages may not have been filled
  layout.places.resize(layout.pieces.size());
  std::vector<std::uint32_t> left;
  for (std::uint32_t p = 0; p < pages; ++p) {
    const Nest& nest = found[p].nest;
    for (std::uint32_t i = 0; i < layout.pieces.size(); ++i)
      if (nest.places[i].placed) {
        layout.page[i] = p;
        layout.places[i] = nest.places[i];
      }
    left.insert(left.end(), nest.left_over.begin(), nest.left_over.end());
    layout.layouts += found[p].layouts;
  }
  layout.page_sizes.assign(pages, {side_, side_});
  return place_left_over(left, open, layout);
}

std::int64_t OutlineFit::cells_of_pages(std::uint32_t pages) const {
  return std::int64_t{side_} * side_ * pages;
}

std::int64_t OutlineFit::cells_of(std::span<const Piece> pieces) {
  std::int64_t total = 0;
  for (const Piece& p : pieces) total += p.cells();
  return total;
}

bool OutlineFit::group(std::uint32_t pages, OutlineLayout& layout) const {
  if (cells_of(layout.pieces) > cells_of_pages(pages)) return false;
  std::vector<std::uint64_t> cells;
  for (const Piece& p : layout.pieces) cells.push_back(static_cast<std::uint64_t>(p.cells()));
  return group_areas(cells, pages, context_, layout.grouping);
}

NestSearchOptions OutlineFit::search_of(std::size_t page) const {
  constexpr std::uint64_t kLayouts = 300, kBestLayouts = 3000, kWork = 16'000'000,
                          kBestWork = 400'000'000;
  // About eight packings in a search for the scale fail, and these use up their limit.
  constexpr std::uint64_t kPackings = 8, kWordsALayout = 25'000;
  NestSearchOptions search;
  search.width = search.enough = side_;
  search.seed = page + 1;
  search.work = kWork;
  if (options_.preset != PackPreset::best) {
    search.layouts = kLayouts;
  } else if (options_.pages > 1) {
    // On tiny pages this many words are millions of layouts: 20 charts on four pages of 64 texels
    // took 33 s, and no more than the first thousands of layouts gained anything.
    search.layouts = kBestLayouts;
    search.work = kBestWork;
  } else if (options_.effort == 0) {
    search.work = kBestWork;
  } else {
    // Without this limit, every packing that failed, which were a dozen in the search for the
    // scale, tried 40 000 layouts of six charts. That took 12 s and gained 1.7 percentage points on
    // a page of 64 texels.
    const std::uint64_t share = options_.effort / kPackings;
    search.layouts = std::max(kLayouts, share);
    search.work = std::clamp(std::min(share, kBestWork) * kWordsALayout, kWork, kBestWork);
  }
  search.work /= options_.pages;
  return search;
}

NestSearchResult OutlineFit::fill_group(std::span<const Piece> pieces,
                                        std::span<const std::vector<std::uint32_t>> orders,
                                        std::size_t p, BitPage& page) const {
  NestSearchResult filled;
  filled.layouts = 1;
  NestPlan plan;
  plan.order = orders[p];
  plan.direction.assign(pieces.size(), kFree);
  plan.cancel = context_.cancel;
  place_pieces(pieces, plan, page, filled.nest);
  if (context_.cancelled()) return filled;
  if (filled.nest.left_over.empty() || options_.preset == PackPreset::fast) return filled;
  if (plan.order.size() < 2) return filled;  // one chart has been tried in every direction
  // A search over orders is only worthwhile if it can try more than a few.
  const NestSearchOptions search = search_of(p);
  if (layout_cost(plan.order.size(), side_, grid_.directions) * 4 > double(search.work))
    return filled;
  NestSearchResult found = search_nest(pieces, plan, search, context_);
  filled.layouts += found.layouts;
  if (!found.nest.left_over.empty() || found.nest.used_height > side_) return filled;
  filled.nest = std::move(found.nest);
  page.clear();
  for (std::uint32_t i : plan.order) {
    const NestPlace& at = filled.nest.places[i];
    if (at.placed) page.put(pieces[i].masks[at.direction], at.at);
  }
  return filled;
}

bool OutlineFit::place_left_over(std::vector<std::uint32_t> left, std::vector<BitPage>& open,
                                 OutlineLayout& layout) const {
  std::stable_sort(left.begin(), left.end(), [&](std::uint32_t a, std::uint32_t b) {
    return layout.pieces[a].cells() > layout.pieces[b].cells();
  });
  for (std::uint32_t i : left) {
    bool placed = false;
    for (std::uint32_t p = 0; p < open.size() && !placed; ++p) {
      NestPlan one;
      one.order = {i};
      one.direction.assign(layout.pieces.size(), kFree);
      Nest nest;
      place_pieces(layout.pieces, one, open[p], nest);
      placed = nest.left_over.empty();
      if (!placed) continue;
      layout.page[i] = p;
      layout.places[i] = nest.places[i];
    }
    if (!placed || context_.cancelled()) return false;
  }
  return true;
}

}  // namespace atlas::pack
