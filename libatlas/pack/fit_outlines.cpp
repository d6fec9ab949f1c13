#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "libatlas/core/parallel.h"
#include "libatlas/pack/fit_bounds.h"
#include "libatlas/pack/fit_pages.h"
#include "libatlas/pack/fit_result.h"
#include "libatlas/pack/nest.h"
#include "libatlas/pack/shape_check.h"
#include "libatlas/pack/straight_page.h"

namespace atlas::pack {
namespace {

struct OutlineLayout {
  double scale = 0;
  std::vector<Piece> pieces;
  std::vector<double> factors;
  std::vector<std::uint32_t> page;  // 1 a piece
  std::vector<NestPlace> places;    // 1 a piece
  std::vector<Extent> page_sizes;   // cells
  std::uint32_t moved = 0;
  GroupingResult grouping;
};

class OutlineFit {
 public:
  OutlineFit(std::span<const FitItem> items, std::span<const ChartOutline> outlines,
             const FitOptions& options, const Context& context)
      : items_(items), outlines_(outlines), options_(options), context_(context) {
    const std::uint32_t rotations =
        options.allow_rotation ? options.rotations : std::min(options.rotations, 1u);
    // A tenth of a second a packing and page, much less with many charts.
    grid_ = choose_grid({items.size() / options.pages + 1, options.page_size, options.alignment,
                         rotations, options.preset == PackPreset::fast ? 5e6 : 30e6});
    side_ = options.page_size / grid_.cell;
    for (const ChartOutline& o : outlines) area_ += o.area;
  }

  double area() const { return area_; }
  const ChartOutline& outline(std::size_t chart) const { return outlines_[chart]; }
  const GridChoice& grid() const { return grid_; }
  std::int32_t side() const { return side_; }
  const FitOptions& options() const { return options_; }
  const Context& context() const { return context_; }

  FitBounds bounds() const {
    return fit_bounds(outlines_, options_, side_ * grid_.cell, grid_.directions);
  }

  // Of all pages, that masks take at this scale: found by drawing them, without packing.
  double share(double scale) const {
    OutlineLayout layout;
    prepare(scale, layout);
    return double(cells_of(layout.pieces)) / double(cells_of_pages(options_.pages));
  }

  // First with the groups of F(A) = N. They are balanced by area, but the first ones hold the few
  // largest charts and nothing to fill the gaps with; where they fail, charts are dealt out such
  // that every page gets large and small ones. A scale at which the groups failed is remembered:
  // above it they are not tried again.
  bool pack_at(double scale, std::uint32_t pages, OutlineLayout& layout) {
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

  // Packs the charts of one page again into the smallest page size that holds them.
  void shrink_page(std::uint32_t page, OutlineLayout& layout) const {
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

 private:
  void prepare(double scale, OutlineLayout& layout) const {
    layout.factors.resize(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const double side = std::max(items_[i].width, items_[i].height);
      const double least = std::min<double>(options_.minimum_side, std::ceil(side));
      layout.factors[i] =
          side > 0 ? std::max(scale, std::min(options_.max_scale, least / side)) : scale;
    }
    PieceOptions piece_options;
    piece_options.factors = layout.factors;
    piece_options.padding = options_.padding;
    piece_options.cell = grid_.cell;
    piece_options.directions = grid_.directions;
    piece_options.page = {side_, side_};
    layout.pieces = make_pieces(outlines_, piece_options, context_);
  }

  // Largest first, each to the page with the least in it.
  void deal_out(std::uint32_t pages, OutlineLayout& layout) const {
    std::vector<std::int64_t> load(pages);
    for (std::uint32_t i : plan_by_size(layout.pieces).order) {
      const auto least = std::min_element(load.begin(), load.end());
      layout.page[i] = static_cast<std::uint32_t>(least - load.begin());
      *least += layout.pieces[i].cells();
    }
  }

  // Packs every page with the charts that layout.page gives it; what is left over moves.
  bool pack_pages(std::uint32_t pages, OutlineLayout& layout) const {
    std::vector<BitPage> open;
    std::vector<Nest> nests(pages);
    const std::int32_t longest = longest_run(layout.pieces);
    for (std::uint32_t p = 0; p < pages; ++p) open.emplace_back(side_, side_, longest);
    std::vector<std::vector<std::uint32_t>> orders(pages);
    for (const std::uint32_t i : plan_by_size(layout.pieces).order)
      orders[layout.page[i]].push_back(i);
    parallel_for(context_, pages, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p)
        nests[p] = fill_group(layout.pieces, orders, p, open[p]);
    });
    layout.places.resize(layout.pieces.size());
    std::vector<std::uint32_t> left;
    for (std::uint32_t p = 0; p < pages; ++p) {
      for (std::uint32_t i = 0; i < layout.pieces.size(); ++i)
        if (nests[p].places[i].placed) {
          layout.page[i] = p;
          layout.places[i] = nests[p].places[i];
        }
      left.insert(left.end(), nests[p].left_over.begin(), nests[p].left_over.end());
    }
    layout.page_sizes.assign(pages, {side_, side_});
    return place_left_over(left, open, layout);
  }

  std::int64_t cells_of_pages(std::uint32_t pages) const {
    return std::int64_t{side_} * side_ * pages;
  }

  static std::int64_t cells_of(std::span<const Piece> pieces) {
    std::int64_t total = 0;
    for (const Piece& p : pieces) total += p.cells();
    return total;
  }

  bool group(std::uint32_t pages, OutlineLayout& layout) const {
    if (cells_of(layout.pieces) > cells_of_pages(pages)) return false;
    std::vector<std::uint64_t> cells;
    for (const Piece& p : layout.pieces) cells.push_back(static_cast<std::uint64_t>(p.cells()));
    return group_areas(cells, pages, context_, layout.grouping);
  }

  // Page p gets the charts orders[p], largest first.
  Nest fill_group(std::span<const Piece> pieces, std::span<const std::vector<std::uint32_t>> orders,
                  std::size_t p, BitPage& page) const {
    Nest nest;
    NestPlan plan;
    plan.order = orders[p];
    plan.direction.assign(pieces.size(), kFree);
    place_pieces(pieces, plan, page, nest);
    if (nest.left_over.empty() || options_.preset == PackPreset::fast) return nest;
    if (plan.order.size() < 2) return nest;  // one chart has been tried in every direction
    // A search over orders is worth it where it can try more than a few.
    NestSearchOptions search;
    search.width = search.enough = side_;
    search.seed = p + 1;
    if (options_.preset != PackPreset::best) search.layouts = 300;
    search.work =
        (options_.preset == PackPreset::best ? 400'000'000u : 16'000'000u) / orders.size();
    if (layout_cost(plan.order.size(), side_, grid_.directions) * 4 > double(search.work))
      return nest;
    Nest found = search_nest(pieces, plan, search, context_).nest;
    if (!found.left_over.empty() || found.used_height > side_) return nest;
    page.clear();
    for (std::uint32_t i : plan.order)
      if (found.places[i].placed)
        page.put(pieces[i].masks[found.places[i].direction], found.places[i].at);
    return found;
  }

  // Charts without room in their group's page go to the first page that has some, largest first.
  bool place_left_over(std::vector<std::uint32_t> left, std::vector<BitPage>& open,
                       OutlineLayout& layout) const {
    std::stable_sort(left.begin(), left.end(), [&](std::uint32_t a, std::uint32_t b) {
      return layout.pieces[a].cells() > layout.pieces[b].cells();
    });
    layout.moved = static_cast<std::uint32_t>(left.size());
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

  std::span<const FitItem> items_;
  std::span<const ChartOutline> outlines_;
  const FitOptions& options_;
  const Context& context_;
  GridChoice grid_;
  std::int32_t side_ = 0;
  double area_ = 0;
  double groups_fail_at_ = std::numeric_limits<double>::infinity();
};

// Up by steps while it fits, down while it does not, then halving: few packings, each seen to fit
// or not. The guess is the scale at which shapes fill 74 % of the pages, or a little more than what
// `best` has come to already.
bool search_scale(OutlineFit& fit, FitResult& result, OutlineLayout& best) {
  const FitOptions& options = fit.options();
  const Context& context = fit.context();
  const auto attempt = [&](double scale) {
    OutlineLayout layout;
    ++result.packings;
    const bool ok = fit.pack_at(scale, options.pages, layout);
    result.trace.emplace_back(scale, ok);
    if (ok && scale > best.scale) best = std::move(layout);
    context.report("pack", std::min(1.0, double(result.packings) / options.max_packings));
    return ok;
  };
  const double pages = double(options.page_size) * options.page_size * options.pages;
  const FitBounds bounds = fit.bounds();
  if (bounds.gutters_exceed_pages) return false;
  const double most = std::min(options.max_scale, bounds.alone);
  double scale = fit.area() > 0 ? std::sqrt(0.74 * pages / fit.area()) : options.max_scale;
  scale = std::min({scale, most, bounds.with_gutters});
  constexpr double kLittleMore = 1.02;
  if (best.scale > 0) scale = std::min(most, kLittleMore * best.scale);
  if (scale <= best.scale) return true;
  const double tolerance = scale_tolerance(options, 0.005, options.shapes.size());
  double low = best.scale, high = most * (1 + 1e-9), step = 0.97;
  const double least = 1e-9 * options.max_scale;  // at which minimum sides hold for all charts
  constexpr double kTight = 0.8;                  // of the pages: such masks seldom fit
  std::uint32_t failures = 0;
  const std::uint32_t in_vain = low > 0 ? 0 : result.packings;  // those of a search before
  while (result.packings + 1 < options.max_packings + in_vain && !context.cancelled()) {
    const bool ok = attempt(scale);
    if (ok && scale >= most) return true;
    (ok ? low : high) = scale;
    if (low > 0 && high - low < tolerance * high) return true;
    if (low == 0) {
      // Minimum sides that take all pages are no matter of the scale. Twice in vain is rare where
      // they do not.
      if (++failures == 2) {
        const double share = fit.share(least);
        if (share > 1 || (share > kTight && !attempt(least))) return false;
        if (share > kTight) low = least;
      }
      scale *= step;
      step *= step > 0.5 ? 0.97 : 1;  // faster and faster, should minimum sides be in the way
    } else {
      scale = high > most ? std::min(most, low * kLittleMore) : (low + high) / 2;
    }
  }
  return low > 0 || attempt(least);
}

// The least page of any shape that holds the layout's one page, cells.
std::int64_t page_in_use(const OutlineLayout& layout) {
  std::int64_t width = 0, height = 0;
  for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
    if (layout.pieces[i].cells() == 0) continue;
    const NestPlace& at = layout.places[i];
    const Mask& mask = layout.pieces[i].masks[at.direction];
    width = std::max<std::int64_t>(width, at.at.x + mask.width);
    height = std::max<std::int64_t>(height, at.at.y + mask.height);
  }
  return width * height;
}

// On a page of any shape the largest scale is not always the best: where the longest chart takes
// all of the page's side, others may fit beside each other at a slightly smaller one, on a far
// smaller page.
void fill_free_page(OutlineFit& fit, FitResult& result, OutlineLayout& best) {
  constexpr double kAtTheSide = 0.98, kStep = 0.97, kLeast = 0.7;
  constexpr double kFuller = 1.05;  // what a smaller scale must gain
  const auto fill = [&](const OutlineLayout& layout) {
    return layout.scale * layout.scale * fit.area() / double(page_in_use(layout));
  };
  const double largest = best.scale;
  if (largest < kAtTheSide * fit.bounds().alone) return;
  double wanted = kFuller * fill(best);
  for (double scale = kStep * largest; scale > kLeast * largest; scale *= kStep) {
    OutlineLayout smaller;
    ++result.packings;
    if (fit.context().cancelled() || !fit.pack_at(scale, 1, smaller)) return;
    if (fill(smaller) < wanted) continue;
    wanted = fill(smaller);
    best = std::move(smaller);
  }
}

void use_fewer_pages(OutlineFit& fit, const FitOptions& options, FitResult& result,
                     OutlineLayout& best) {
  double cells = 0;
  for (const Piece& p : best.pieces) cells += static_cast<double>(p.cells());
  auto n = static_cast<std::uint32_t>(cells / (0.9 * fit.side() * double(fit.side()))) + 1;
  for (; n < best.page_sizes.size() && result.packings < options.max_packings; ++n) {
    OutlineLayout fewer;
    ++result.packings;
    if (!fit.pack_at(best.scale, n, fewer)) continue;
    best = std::move(fewer);
    return;
  }
}

void write_result(const OutlineFit& fit, const FitOptions& options, OutlineLayout& best,
                  FitResult& result) {
  const std::int32_t cell = fit.grid().cell;
  result.scale = best.scale;
  result.pages.assign(best.page_sizes.size(), {0, 0});
  if (options.power_of_two)
    for (std::uint32_t p = 0; p < result.pages.size(); ++p) {
      if (best.scale == options.max_scale) fit.shrink_page(p, best);
      const Extent size = best.page_sizes[p];
      result.pages[p] = {size.width * cell, size.height * cell};
    }
  result.placements.resize(best.pieces.size());
  double shapes = 0;
  for (std::size_t i = 0; i < best.pieces.size(); ++i) {
    const Piece& piece = best.pieces[i];
    FitPlacement& out = result.placements[i];
    out.scale = best.factors[i];
    out.page = best.page[i];
    if (piece.cells() == 0) {
      write_at_corner(fit.outline(i), out);
      continue;
    }
    const NestPlace& at = best.places[i];
    const Mask& mask = piece.masks[at.direction];
    const Rect box{at.at.x * cell, at.at.y * cell, mask.width * cell, mask.height * cell};
    const Vec2d origin = piece.origins[at.direction];
    write_outline({box,
                   2 * std::numbers::pi * at.direction / fit.grid().directions,
                   {box.x + origin.x, box.y + origin.y}},
                  options, out);
    shapes += fit.outline(i).area * out.scale * out.scale;
    if (!options.power_of_two) enclose(box, options, result.pages[out.page]);
  }
  drop_empty_pages(result);
  result.utilization = share_of_pages(shapes, result);
  result.moved_items = best.moved;
  result.grouping = std::move(best.grouping);
}

constexpr std::size_t kFewInRows = 64;  // charts

}  // namespace

Result<FitResult> fit_outlines(std::span<const FitItem> items, const FitOptions& options,
                               const Context& context) {
  FitResult result;
  const std::vector<ChartOutline> outlines = outlines_of(options.shapes, context);
  std::optional<FitResult> pressed = fit_pressed(items, outlines, options, context);
  // Straight charts, laid in rows on a page of any shape or pressed by `best` on a given one, may
  // fill more by cells. Of many charts rows are about as good, and far cheaper.
  const bool many = options.free_aspect && items.size() > kFewInRows;
  if (pressed && (many || !is_straight(outlines))) return std::move(*pressed);
  if (context.cancelled()) return Status::cancelled();
  FitOptions by_cells = options;
  if (pressed) by_cells.preset = PackPreset::standard;
  // With more directions each chart finds a lower place, but not all charts a higher scale: those
  // that lie askew keep others from lying straight. So four come first, and more have to beat them.
  FitOptions by_quarters = by_cells;
  by_quarters.rotations = std::min(by_cells.rotations, 4u);
  OutlineFit quarters(items, outlines, by_quarters, context);
  OutlineFit all(items, outlines, by_cells, context);
  OutlineFit* fit = &quarters;
  OutlineLayout best;
  bool found = search_scale(quarters, result, best);
  if (all.grid().directions > quarters.grid().directions) {
    const double before = best.scale;
    found = search_scale(all, result, best) || found;
    if (best.scale > before) fit = &all;
  }
  if (context.cancelled()) return Status::cancelled();
  if (pressed && (!found || (!options.free_aspect && best.scale <= pressed->scale)))
    return std::move(*pressed);
  if (!found) return no_room(items.size(), options);
  if (options.free_aspect && options.pages == 1) fill_free_page(*fit, result, best);
  if (best.scale == options.max_scale) use_fewer_pages(*fit, options, result, best);
  write_result(*fit, options, best, result);
  if (pressed && options.free_aspect && pressed->utilization >= result.utilization)
    return std::move(*pressed);
  return result;
}

}  // namespace atlas::pack
