#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "libatlas/core/progress.h"
#include "libatlas/pack/fitting/fit_many.h"
#include "libatlas/pack/fitting/fit_pages.h"
#include "libatlas/pack/fitting/fit_result.h"
#include "libatlas/pack/fitting/outline_fit.h"
#include "libatlas/pack/nesting/overlap_search.h"
#include "libatlas/pack/outlines/shape_check.h"
#include "libatlas/pack/pressing/specks.h"
#include "libatlas/pack/pressing/straight_page.h"

namespace atlas::pack {
namespace {

// Increases the scale in steps while it fits, or decreases it until it fits, and then bisects. This
// takes few packings, and each scale was seen to fit or not. The first guess is the scale at which
// shapes fill 74 % of the pages, or slightly more than the scale that `best` already has.
bool search_scale(OutlineFit& fit, FitResult& result, OutlineLayout& best) {
  const FitSearchOptions& options = fit.options();
  const Context& context = fit.context();
  const auto attempt = [&](double scale) {
    OutlineLayout layout;
    ++result.packings;
    const bool ok = fit.pack_at(scale, options.pages, layout);
    result.layouts += layout.layouts;
    if (ok && scale > best.scale) best = std::move(layout);
    context.report("packing", std::min(1.0, double(result.packings) / options.max_packings));
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
  if (scale <= best.scale) return best.scale > 0;
  constexpr double kTolerance = 0.005;  // relative
  double low = best.scale, high = most * (1 + 1e-9), step = 0.97;
  // A scale at which all charts have their minimum sides.
  const double least = 1e-9 * options.max_scale;
  constexpr double kTight = 0.8;  // share of the pages; masks that take more seldom fit
  std::uint32_t failures = 0;
  // The packings of an earlier search that found no scale.
  const std::uint32_t in_vain = low > 0 ? 0 : result.packings;
  const auto over = [&] { return context.cancelled() || wall_seconds() >= options.deadline; };
  while (result.packings + 1 < options.max_packings + in_vain && !over()) {
    const bool ok = attempt(scale);
    if (ok && scale >= most) return true;
    (ok ? low : high) = scale;
    if (low > 0 && high - low < kTolerance * high) return true;
    if (low == 0) {
      // If the minimum sides alone take all pages, no scale helps. If they do not, two failures in
      // a row are rare, so this is checked after the second failure.
      if (++failures == 2) {
        const double share = fit.share(least);
        if (share > 1 || (share > kTight && !attempt(least))) return false;
        if (share > kTight) low = least;
      }
      scale *= step;
      step *= step > 0.5 ? 0.97 : 1;  // ever faster, in case minimum sides are the obstacle
    } else {
      scale = high > most ? std::min(most, low * kLittleMore) : (low + high) / 2;
    }
  }
  return low > 0 || (!over() && attempt(least));
}

// Returns the area in cells of the smallest rectangle, of any shape, that holds the layout's one
// page.
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

// Returns the share of that rectangle that the charts fill.
double fill(const OutlineFit& fit, const OutlineLayout& layout) {
  const double cell = fit.grid().cell;
  return layout.scale * layout.scale * fit.area() / (cell * cell * double(page_in_use(layout)));
}

// Searches once more for a single page, with large frames first, so that small charts then lie
// within them.
void place_by_boxes(OutlineFit& fit, FitResult& result, OutlineLayout& best) {
  fit.place(LargestBy::boxes);
  OutlineLayout larger;
  larger.scale = best.scale;
  search_scale(fit, result, larger);
  if (larger.scale == best.scale) return;
  if (fit.options().free_aspect && fill(fit, larger) <= fill(fit, best)) return;
  best = std::move(larger);
}

// On a page of any shape the largest scale is not always the best. If the longest chart takes the
// whole side of the page, a slightly smaller scale may let other charts fit beside each other, on a
// far smaller page.
void fill_free_page(OutlineFit& fit, FitResult& result, OutlineLayout& best) {
  constexpr double kAtTheSide = 0.98, kStep = 0.97, kLeast = 0.7;
  // Share of the page; above it, a dozen packings are not worth their time.
  constexpr double kFull = 0.75;
  constexpr double kFuller = 1.05;  // the factor by which a smaller scale must raise the fill
  const double largest = best.scale;
  if (fill(fit, best) > kFull || largest < kAtTheSide * fit.bounds().alone) return;
  double wanted = kFuller * fill(fit, best);
  for (double scale = kStep * largest; scale > kLeast * largest; scale *= kStep) {
    OutlineLayout smaller;
    if (++result.packings > fit.options().max_packings || fit.context().cancelled()) return;
    const bool fits = fit.pack_at(scale, 1, smaller);
    result.layouts += smaller.layouts;
    if (!fits) return;
    if (fill(fit, smaller) < wanted) continue;
    wanted = fill(fit, smaller);
    best = std::move(smaller);
  }
}

// Looks for the smallest number of pages by bisection.
void use_fewer_pages(OutlineFit& fit, const FitOptions& options, FitResult& result,
                     OutlineLayout& best) {
  double cells = 0;
  for (const Piece& p : best.pieces) cells += static_cast<double>(p.cells());
  auto low = static_cast<std::uint32_t>(cells / (0.9 * fit.side() * double(fit.side()))) + 1;
  auto high = static_cast<std::uint32_t>(best.page_sizes.size());
  while (low < high && result.packings < options.max_packings) {
    const std::uint32_t n = low + (high - low) / 2;
    OutlineLayout fewer;
    ++result.packings;
    const bool fits = fit.pack_at(best.scale, n, fewer);
    result.layouts += fewer.layouts;
    (fits ? high : low) = fits ? n : n + 1;
    if (fits) best = std::move(fewer);
  }
}

void write_result(const OutlineFit& fit, const FitOptions& options, OutlineLayout& best,
                  FitResult& result) {
  const std::int32_t cell = fit.grid().cell;
  result.scale = best.scale;
  result.pages.assign(best.page_sizes.size(), {0, 0});
  if (options.power_of_two) {
    if (best.scale == options.max_scale) fit.shrink_pages(best);
    for (std::uint32_t p = 0; p < result.pages.size(); ++p) {
      const Extent size = best.page_sizes[p];
      result.pages[p] = {size.width * cell, size.height * cell};
    }
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
  result.grouping = in_texels(std::move(best.grouping), cell);
}

// With more directions each chart finds a lower place, but the common scale does not always become
// larger, because charts that lie askew keep others from lying straight. So four directions come
// first, and more directions have to beat them. Returns the fit that found `best`; null if none
// did.
OutlineFit* search_directions(OutlineFit& quarters, OutlineFit& all, FitResult& result,
                              OutlineLayout& best) {
  const bool found = search_scale(quarters, result, best);
  if (all.grid().directions <= quarters.grid().directions) return found ? &quarters : nullptr;
  OutlineLayout turned;
  turned.scale = best.scale;
  const bool found_turned = search_scale(all, result, turned);
  // Along the diagonal of a page of any shape, a lone long chart is larger, but the page is all but
  // empty.
  const bool lone = found && all.options().free_aspect && best.pieces.size() == 1;
  if (turned.scale <= best.scale || (lone && fill(all, turned) < fill(quarters, best)))
    return found || found_turned ? &quarters : nullptr;
  best = std::move(turned);
  return &all;
}

// Makes a page of any shape lower than any order of placing charts does, by letting charts overlap
// for a while.
void lower_page(const OutlineFit& fit, double share, OutlineLayout& best) {
  // Pages of 129 to 500 charts became fuller by 0.3 points in 0.1 to 0.3 s, which only long rounds
  // are for. With more charts, all their pairs take even longer.
  constexpr std::size_t kFew = 128, kMost = 500;
  if (best.pieces.size() > (share > 1 ? kMost : kFew)) return;
  OverlapSearchOptions overlap;
  Nest nest;
  nest.places = best.places;
  for (std::size_t i = 0; i < best.pieces.size(); ++i) {
    if (!best.places[i].placed) continue;
    const Mask& mask = best.pieces[i].masks[best.places[i].direction];
    overlap.width = std::max(overlap.width, best.places[i].at.x + mask.width);
    nest.used_height = std::max(nest.used_height, best.places[i].at.y + mask.height);
  }
  overlap.work = std::uint64_t(share * round_work(best.pieces.size()));
  overlap.seed = fit.options().seed;
  overlap.deadline = fit.options().deadline;
  search_overlaps(best.pieces, overlap, fit.context(), nest);
  best.places = std::move(nest.places);
}

// Returns whether a page that the search over cells has filled to this share is pressed in a second
// try. With specks, which the search lays into the gaps as well, pressing gains little unless the
// page is poorly filled, and seldom more than kMostPressed.
bool worth_pressing_late(double fill, const FitSearchOptions& options) {
  constexpr double kPoorFill = 0.7, kMostPressed = 1.08;
  return fill < kPoorFill && kMostPressed * fill >= options.wanted_fill;
}

// Returns whether the search over cells may fill a page more that pressing has filled to this
// share. Thin charts that reach into each other everywhere, as zigzags and combs do, keep more
// distance as rigid bodies than as masks. Eight sets of charts filled 0.274 of their page on
// average, and 0.336 by what was fuller, in a third of a second more; two became no fuller.
bool worth_searching_late(double fill, const FitSearchOptions& options) {
  constexpr double kVeryPoorFill = 0.5, kMostByCells = 1.6;
  return fill < kVeryPoorFill && kMostByCells * fill >= options.wanted_fill;
}

// Takes `next` if it is better than `best`, or adds its layouts to those of `best`.
void take_better(std::optional<FitResult> next, const FitOptions& options,
                 std::optional<FitResult>& best) {
  if (!next) return;
  const bool better = !best || (options.free_aspect ? next->utilization > best->utilization
                                                    : next->scale > best->scale);
  const std::uint64_t layouts = next->layouts + (best ? best->layouts : 0);
  if (better) best = std::move(next);
  best->layouts = layouts;
}

// Searches for the largest scale at which charts fit on cells, with this share of round_work(). On
// pages of given shape, it looks for scales above `known` only. Returns nothing if there is none.
std::optional<FitResult> fit_on_cells(const FitCharts& charts, const FitSearchOptions& options,
                                      double known, const Context& context) {
  const auto items = charts.items;
  const auto outlines = charts.outlines;
  FitSearchOptions by_quarters = options;
  by_quarters.rotations = std::min(options.rotations, 4u);
  OutlineFit quarters(items, outlines, by_quarters, context);
  OutlineFit all(items, outlines, options, context);
  FitResult result;
  OutlineLayout best;
  best.scale = known;
  OutlineFit* fit = search_directions(quarters, all, result, best);
  if (!fit) return std::nullopt;
  if (options.pages == 1 && items.size() < kManyItems) place_by_boxes(*fit, result, best);
  if (context.cancelled() || best.pieces.empty()) return std::nullopt;
  if (options.free_aspect && options.pages == 1 && items.size() > 1) {
    fill_free_page(*fit, result, best);
    if (options.preset != PackPreset::fast) lower_page(*fit, options.first_round, best);
  }
  if (best.scale == options.max_scale) use_fewer_pages(*fit, options, result, best);
  write_result(*fit, options, best, result);
  return result;
}

// Presses the charts if they are few, else searches for the largest scale at which they fit. On
// pages of given shape, it looks for scales above `known` only, and returns nothing if there is
// none.
Result<std::optional<FitResult>> search_outlines(const FitCharts& charts,
                                                 const FitSearchOptions& options, double known,
                                                 const Context& context) {
  const bool specks = has_specks(charts.outlines, options);
  std::optional<FitResult> best;
  if (!specks) best = fit_pressed(charts, options, context);
  if (context.cancelled()) return Status::cancelled();
  // Whether `best` also searches over cells, and how long, must not hang on what pressing has
  // found, which hangs on the effort.
  const bool both = options.preset == PackPreset::best ||
                    (best && (worth_searching_late(best->utilization, options) ||
                              (!options.free_aspect && is_straight(charts.outlines))));
  if (best && !both) return best;
  const bool pressed = !specks && may_be_pressed(charts.outlines, options);
  FitSearchOptions by_cells = options;
  SearchRounds rounds(options, charts.items.size());
  while (rounds.next()) {
    by_cells.first_round = rounds.share();
    const bool above = best && !pressed && !options.free_aspect;
    take_better(fit_on_cells(charts, by_cells, above ? best->scale : known, context), options,
                best);
    if (context.cancelled()) return Status::cancelled();
    if (pressed || !best || best->scale >= options.max_scale) break;
  }
  if (!best) {
    if (known > 0) return best;
    return no_room(charts.items.size(), options);
  }
  if (specks &&
      (options.preset == PackPreset::best || worth_pressing_late(best->utilization, options)))
    take_better(fit_pressed(charts, options, context), options, best);
  if (!pressed) {
    std::optional<FitResult> denser = press_pages(*best, charts, options, context);
    if (denser) best = std::move(denser);
  }
  if (context.cancelled()) return Status::cancelled();
  return best;
}

Result<FitResult> fit_within_time(const FitCharts& charts, const FitSearchOptions& options,
                                  const Context& context) {
  const std::size_t n = charts.items.size();
  std::optional<FitResult> best;
  double begun = 0;  // share of the progress
  if (n >= kSomeOnPage * options.pages) {
    begun = 0.3;
    const Context many = part_of_stage(context, "packing", 0, begun);
    FitSearchOptions standard = options;
    standard.preset = std::min(options.preset, PackPreset::standard);
    best = fit_many(charts, standard, many);
    if (options.preset == PackPreset::best)
      take_better(fit_many(charts, options, many), options, best);
    if (context.cancelled()) return Status::cancelled();
    // Where all charts are as large as they may be, the pages can be smaller or fewer.
    const bool reducible = options.power_of_two || options.pages > 1;
    if (best && reducible && best->scale >= options.max_scale) best.reset();
    if (best && options.free_aspect && n >= kManyOnPage) return std::move(*best);
  }
  const bool many = best && n >= kManyOnPage * options.pages;
  const double known = many && !options.free_aspect ? best->scale : 0;
  Result<std::optional<FitResult>> searched =
      search_outlines(charts, options, known, part_of_stage(context, "packing", begun, 1));
  if (context.cancelled()) return Status::cancelled();
  if (searched.ok()) take_better(std::move(*searched), options, best);
  if (!best) return searched.status();
  return std::move(*best);
}

}  // namespace

Result<FitResult> fit_outlines(const FitCharts& charts, const FitSearchOptions& options,
                               const Context& context) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (options.deadline == kNever) return fit_within_time(charts, options, context);
  // What `fast` finds is there when the time is up, however little it was.
  FitSearchOptions fast = options;
  fast.preset = PackPreset::fast;
  fast.deadline = kNever;
  Context unreported = context;
  unreported.progress = {};
  Result<FitResult> first = fit_within_time(charts, fast, unreported);
  if (!first.ok()) {
    FitSearchOptions unlimited = options;
    unlimited.preset = PackPreset::standard;
    unlimited.deadline = kNever;
    return fit_within_time(charts, unlimited, context);
  }
  std::optional<FitResult> best = std::move(*first);
  if (wall_seconds() >= options.deadline) return std::move(*best);
  Result<FitResult> found = fit_within_time(charts, options, context);
  if (context.cancelled()) return Status::cancelled();
  if (found.ok()) take_better(std::move(*found), options, best);
  return std::move(*best);
}

}  // namespace atlas::pack
