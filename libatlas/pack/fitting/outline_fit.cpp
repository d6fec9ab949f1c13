#include "libatlas/pack/fitting/outline_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libatlas/core/parallel.h"
#include "libatlas/pack/fitting/fit_factors.h"
#include "libatlas/pack/fitting/fit_pages.h"

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

// The pieces of one page, largest first, and their indices in the layout.
struct PagePieces {
  std::vector<std::uint32_t> ids;
  std::vector<Piece> pieces;
};

// Takes the pieces out of the layout and divides them by page. So a page costs what its own pieces
// do, and ten thousand pages do not each go through all pieces.
std::vector<PagePieces> pieces_by_page(OutlineLayout& layout, LargestBy by, std::uint32_t pages) {
  std::vector<PagePieces> groups(pages);
  for (const std::uint32_t i : plan_by_size(layout.pieces, by).order) {
    PagePieces& group = groups[layout.page[i]];
    group.ids.push_back(i);
    group.pieces.push_back(std::move(layout.pieces[i]));
  }
  return groups;
}

void give_back(std::vector<PagePieces>& groups, OutlineLayout& layout) {
  for (PagePieces& group : groups)
    for (std::size_t k = 0; k < group.ids.size(); ++k)
      layout.pieces[group.ids[k]] = std::move(group.pieces[k]);
}

NestPlan in_order(std::span<const Piece> pieces, double deadline, const Context& context) {
  NestPlan plan;
  plan.order.resize(pieces.size());
  std::iota(plan.order.begin(), plan.order.end(), 0u);
  plan.direction.assign(pieces.size(), kFree);
  plan.context = &context;
  plan.deadline = deadline;
  return plan;
}

}  // namespace

OutlineFit::OutlineFit(std::span<const FitItem> items, std::span<const ChartOutline> outlines,
                       const FitSearchOptions& options, const Context& context)
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

bool OutlineFit::over() const {
  return context_.cancelled() || wall_seconds() >= options_.deadline;
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
  layout.page = deal_out(layout.pieces, plan_by_size(layout.pieces).order, pages);
  return pack_pages(pages, layout);
}

void OutlineFit::shrink_pages(OutlineLayout& layout) const {
  const auto pages = static_cast<std::uint32_t>(layout.page_sizes.size());
  std::vector<PagePieces> groups = pieces_by_page(layout, LargestBy::cells, pages);
  const std::vector<Extent> sizes = smaller_pages(options_);
  parallel_for(context_, pages, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const PagePieces& group = groups[p];
      NestPlan plan = in_order(group.pieces, options_.deadline, context_);
      plan.all_or_none = true;
      const std::int64_t cells = cells_of(group.pieces);
      for (const Extent& texels : sizes) {
        const Extent size{texels.width / grid_.cell, texels.height / grid_.cell};
        if (size.area() < cells || size.area() == 0) continue;
        BitPage open(size.width, size.height, longest_run(group.pieces));
        Nest nest;
        place_pieces(group.pieces, plan, open, nest);
        if (!nest.left_over.empty() || over()) continue;
        for (std::size_t k = 0; k < group.ids.size(); ++k)
          layout.places[group.ids[k]] = nest.places[k];
        layout.page_sizes[p] = size;
        break;
      }
    }
  });
  give_back(groups, layout);
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

bool OutlineFit::pack_pages(std::uint32_t pages, OutlineLayout& layout) const {
  std::vector<PagePieces> groups = pieces_by_page(layout, by_, pages);
  std::vector<NestSearchResult> found(pages);
  parallel_for(context_, pages, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) found[p] = fill_group(groups[p].pieces, p);
  });
  give_back(groups, layout);
  if (over()) return false;  // pages may not have been filled
  layout.places.assign(layout.pieces.size(), {});
  std::vector<std::uint32_t> left;
  for (std::uint32_t p = 0; p < pages; ++p) {
    const std::vector<std::uint32_t>& ids = groups[p].ids;
    for (std::size_t k = 0; k < ids.size(); ++k) layout.places[ids[k]] = found[p].nest.places[k];
    for (const std::uint32_t k : found[p].nest.left_over) left.push_back(ids[k]);
    layout.layouts += found[p].layouts;
  }
  layout.page_sizes.assign(pages, {side_, side_});
  return place_left_over(std::move(left), layout);
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
  // About eight packings in a search for the scale fail, and these use up their limit.
  constexpr double kPackings = 8;
  NestSearchOptions search;
  search.width = search.enough = side_;
  search.seed = page + 1;
  search.work = std::uint64_t(options_.first_round * round_work(items_.size()) /
                              (kPackings * kWordsOfPlacing * options_.pages));
  search.deadline = options_.deadline;
  return search;
}

NestSearchResult OutlineFit::fill_group(std::span<const Piece> pieces, std::size_t p) const {
  NestSearchResult filled;
  filled.layouts = 1;
  NestPlan plan = in_order(pieces, options_.deadline, context_);
  // On a single page, charts that are left over have no room elsewhere either.
  plan.all_or_none = options_.pages == 1 && !searches_skip_rows(pieces.size());
  BitPage page(side_, side_, longest_run(pieces));
  place_pieces(pieces, plan, page, filled.nest);
  if (over()) return filled;
  if (filled.nest.left_over.empty() || options_.preset == PackPreset::fast) return filled;
  if (plan.order.size() < 2) return filled;  // one chart has been tried in every direction
  // A search over orders is only worthwhile if it can try more than a few.
  const NestSearchOptions search = search_of(p);
  if (layout_cost(plan.order.size(), side_, grid_.directions) * 4 > double(search.work))
    return filled;
  NestSearchResult found = search_nest(pieces, plan, search, context_);
  filled.layouts += found.layouts;
  if (found.nest.left_over.empty() && found.nest.used_height <= side_)
    filled.nest = std::move(found.nest);
  return filled;
}

bool OutlineFit::place_left_over(std::vector<std::uint32_t> left, OutlineLayout& layout) const {
  std::stable_sort(left.begin(), left.end(), [&](std::uint32_t a, std::uint32_t b) {
    return layout.pieces[a].cells() > layout.pieces[b].cells();
  });
  if (left.empty()) return true;
  if (layout.page_sizes.size() == 1 && !searches_skip_rows(layout.pieces.size())) return false;
  std::vector<std::vector<std::uint32_t>> placed(layout.page_sizes.size());
  std::vector<std::int64_t> room(placed.size(), std::int64_t{side_} * side_);  // in cells
  for (std::uint32_t i = 0; i < layout.pieces.size(); ++i) {
    if (!layout.places[i].placed) continue;
    placed[layout.page[i]].push_back(i);
    room[layout.page[i]] -= layout.pieces[i].cells();
  }
  const std::int32_t longest = longest_run(layout.pieces);
  bool stuck = false;  // whether a chart has no room on the last page either
  for (std::uint32_t p = 0; p < placed.size() && !left.empty(); ++p) {
    BitPage page(side_, side_, longest);
    for (const std::uint32_t i : placed[p]) {
      const NestPlace& at = layout.places[i];
      page.put(layout.pieces[i].masks[at.direction], at.at);
    }
    std::erase_if(left, [&](std::uint32_t i) {
      const std::int64_t cells = layout.pieces[i].cells();
      if (stuck || cells > room[p] || context_.cancelled()) return false;
      Nest nest;
      place_pieces(std::span(&layout.pieces[i], 1), {{0}, {kFree}}, page, nest);
      if (!nest.left_over.empty()) {
        stuck = p + 1 == placed.size();
        return false;
      }
      layout.page[i] = p;
      layout.places[i] = nest.places[0];
      room[p] -= cells;
      return true;
    });
  }
  return left.empty();
}

}  // namespace atlas::pack
