#include "libatlas/pack/pressing/press_starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libatlas/core/parallel.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/random.h"
#include "libatlas/pack/nesting/overlap_search.h"

namespace atlas::pack {
namespace {

// The fill of the page at which the search begins. Only the ratio of charts to gutters depends on
// it.
constexpr double kExpectedFill = 0.8;
// Relative to the page's side: maximum length of a rasterised chart.
constexpr double kMostSides = 2;
constexpr double kMostCells = 1 << 21;  // number of cells of the finest grid in one chart's box
// Starts of a round. Widths matter more on a square page, which is no fuller where its longer side
// alone decides: 8 sets of charts filled 0.715 of it with 20 starts and 0.707 with 10, but pages of
// any shape are no fuller with 20.
constexpr std::size_t kMostStarts = 10, kMostSquareStarts = 20;
// Charts in all starts together; fewer charts get more starts.
constexpr std::size_t kStartedCharts = 960;
// By how much the widths of starts differ, relative to the square page's side.
constexpr double kSpread = 0.2, kSquareSpread = 0.1;
// Of the starts of a round, so many are made lower by letting charts overlap for a while.
constexpr std::size_t kLowered = 4;
// Shares of a round's work: searching for orders of placing charts, and letting charts overlap.
// What is left is pressing.
constexpr double kOrders = 0.4, kOverlaps = 0.4;
// The shares of their limits after which the searches of long rounds are compared, and the worse
// half given up. Searches over few charts are not compared, because one lucky layout decides there.
constexpr std::array kLegs{1 / 32.0, 1 / 16.0, 1 / 8.0, 1.0};
constexpr std::array kAllAtOnce{1.0};
constexpr std::size_t kLeastLeft = 4, kFewCharts = 5;
constexpr std::uint32_t kDirections = 24;
// The number of cells across a page: normally, for many charts, and from the second draw on. Finer
// cells lose less of the gaps between charts with narrow limbs, but they take longer.
constexpr int kCells = 128, kCellsOfMany = 192, kFineCells = 256;
constexpr std::size_t kManyCharts = 48;
// Relative to the square page's side: charts longer than kLong may lie along the strip, and kNarrow
// is the width of the narrowest strip.
constexpr double kLong = 1.2, kNarrow = 0.4;
constexpr int kTurns = 180;  // number of directions of a single chart within a quarter turn

std::size_t most_starts(const FitOptions& options) {
  return options.free_aspect ? kMostStarts : kMostSquareStarts;
}

}  // namespace

double goodness(const SqueezePage& page, const FitOptions& options) {
  if (!(page.width > 0)) return 0;
  const double longer = std::max(page.width, page.height);
  return 1 / (options.free_aspect ? page.width * page.height : longer * longer);
}

PressStarts::PressStarts(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                         const Context& context)
    : outlines_(outlines), options_(options), context_(context) {
  double area = 0;
  for (const ChartOutline& o : outlines) area += o.area;
  const double page = double(options.page_size) * options.page_size;
  double longest = 0;
  for (const ChartOutline& o : outlines) {
    const Vec2d box = box_of(o, 0);
    longest = std::max({longest, box.x, box.y});
  }
  // A longer chart will lie along the page, and the scale is far smaller than its area suggests.
  const double by_area = std::sqrt(kExpectedFill * page / area);
  scale_ = std::min(by_area, kMostSides * options.page_size / longest);
  side_ = options.page_size * (scale_ / by_area);
  draw();
}

std::vector<PressStart> PressStarts::make(std::uint32_t round, double share) {
  draw_pieces(round > 0 ? kFineCells : outlines_.size() < kManyCharts ? kCells : kCellsOfMany);
  const std::size_t n = std::max<std::size_t>(1, outlines_.size());
  if (n == 1) return {alone()};
  const std::size_t count = std::clamp<std::size_t>(kStartedCharts / n, 1,
                                                    layouts_of_round(most_starts(options_), share));
  const double work = kOrders * share * round_work(n) / (double(count) * kWordsOfPlacing);
  std::vector<Runner> runners;
  for (std::size_t k = 0; k < count; ++k) runners.push_back(runner(k, count, round, work));
  race(runners, round);
  lower_fullest(runners, share);
  std::vector<PressStart> starts;
  for (Runner& r : runners) starts.push_back(std::move(r.start));
  return starts;
}

double PressStarts::scale_on_page(const SqueezePage& page) const {
  const double side = std::max(page.width, page.height);
  return side > 0 ? scale_ * options_.page_size / side : 0;
}

// Runs these searches until this share of their limits is used up, and sorts them, best first.
void PressStarts::run(std::vector<Runner*>& runners, double share) const {
  parallel_for(context_, runners.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Runner& r = *runners[k];
      note(r.search.run(share, context_), r);
    }
  });
  std::stable_sort(runners.begin(), runners.end(), [&](const Runner* a, const Runner* b) {
    return goodness(a->start.page, options_) > goodness(b->start.page, options_);
  });
}

// Runs the searches of all starts. Whether a strip's width suits the charts shows early, so the
// worse half is given up on the way of long rounds.
void PressStarts::race(std::vector<Runner>& runners, std::uint32_t round) const {
  std::vector<Runner*> left;
  for (Runner& r : runners) left.push_back(&r);
  const bool at_once = round == 0 || pieces_.size() <= kFewCharts;
  for (const double share : at_once ? std::span<const double>(kAllAtOnce) : std::span(kLegs)) {
    run(left, share);
    left.resize(std::clamp<std::size_t>((left.size() + 1) / 2, std::min(kLeastLeft, left.size()),
                                        left.size()));
  }
}

// Makes the layouts of the fullest starts lower than any order of placing charts does.
void PressStarts::lower_fullest(std::vector<Runner>& runners, double share) const {
  std::vector<Runner*> fullest;
  for (Runner& r : runners)
    if (!r.start.poses.empty()) fullest.push_back(&r);
  std::stable_sort(fullest.begin(), fullest.end(), [&](const Runner* a, const Runner* b) {
    return goodness(a->start.page, options_) > goodness(b->start.page, options_);
  });
  fullest.resize(std::min(fullest.size(), layouts_of_round(kLowered, share)));
  const double work = kOverlaps * share * round_work(pieces_.size()) / double(fullest.size());
  parallel_for(context_, fullest.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Runner& r = *fullest[k];
      Nest nest = r.search.run(0, context_).nest;
      OverlapSearchOptions overlap;
      overlap.width = r.width;
      // A square page whose width decides does not become smaller.
      overlap.low_enough = options_.free_aspect ? 0 : r.width;
      overlap.work = std::uint64_t(work);
      overlap.deadline = options_.deadline;
      overlap.seed = r.seed;
      search_overlaps(pieces_, overlap, context_, nest);
      take(nest, r);
    }
  });
}

// Rasterises the charts as rigid bodies. The search only needs outlines as fine as its cells,
// because exact masks are used later.
void PressStarts::draw() {
  // What only compares ways to cut charts makes do with bodies that are half as fine.
  const int fine = std::max(1, options_.page_size / 1024) * (options_.first_round < 1 ? 2 : 1);
  const std::size_t n = outlines_.size();
  drawn_.resize(n);
  parallel_for(context_, n, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) draw_one(i, fine);
  });
}

// Rasterises the pieces of the search on a grid with this many cells across the page.
void PressStarts::draw_pieces(int cells) {
  if (cells == cells_) return;
  cells_ = cells;
  cell_ = std::max(1, options_.page_size / cells);
  std::vector<ChartOutline> thin;
  for (const ChartOutline& o : outlines_) thin.push_back(thinned(o, 0.125 * cell_ / scale_));
  PieceOptions pieces;
  pieces.factor = scale_;
  pieces.padding = options_.padding;
  pieces.cell = cell_;
  pieces.directions = kDirections;
  pieces_ = make_pieces(thin, pieces, context_);
}

void PressStarts::draw_one(std::size_t i, int fine) {
  DrawnChart& d = drawn_[i];
  const Vec2d box = box_of(outlines_[i], 0);
  while (scale_ * box.x * scale_ * box.y > kMostCells * fine * fine) fine *= 2;
  RasterOptions raster;
  raster.factor = scale_;
  raster.padding = 0;
  raster.cell = fine;
  const Mask mask = rasterize(outlines_[i], raster, d.origin);
  if (mask.cells == 0) return;
  const double cell = fine;
  d.bodies[DrawnChart::coarse] = make_body(coarsen(mask, 4), 4 * cell, 12 * cell, 10 * cell);
  d.bodies[DrawnChart::fine] = make_body(coarsen(mask, 2), 2 * cell, 8 * cell, 2 * cell);
  // Both bodies get the same centre.
  const Vec2d shift{d.bodies[DrawnChart::fine].center.x - d.bodies[DrawnChart::coarse].center.x,
                    d.bodies[DrawnChart::fine].center.y - d.bodies[DrawnChart::coarse].center.y};
  for (Vec2d& q : d.bodies[DrawnChart::fine].outline) q = {q.x + shift.x, q.y + shift.y};
  make_arcs(d.bodies[DrawnChart::fine]);
  d.bodies[DrawnChart::fine].center = d.bodies[DrawnChart::coarse].center;
  d.bodies[DrawnChart::fine].radius += portable::hypot(shift.x, shift.y);
}

// Returns the width of start k's strip in cells. The widths are spread around the square page's
// side. If pages may have any shape, every fourth strip is narrower, since a few large charts may
// fill it in one row. If a chart is also longer than the side, every second strip lets it lie along
// the strip.
std::int32_t PressStarts::strip_width(std::size_t k, std::size_t count, double shift) const {
  const double side = side_ * std::sqrt(kExpectedFill / 0.69) / cell_;
  const double most_spread = options_.free_aspect ? kSpread : kSquareSpread;
  const double spread =
      (count > 1 ? most_spread * (double(k) / double(count - 1) - 0.5) : 0) + shift;
  std::int32_t narrowest = 0, longest = 0;
  for (const Piece& p : pieces_) {
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    for (const Mask& m : p.masks) {
      least = std::min(least, m.width);
      longest = std::max(longest, m.width);
    }
    if (p.cells() > 0) narrowest = std::max(narrowest, least);
  }
  const bool along = options_.free_aspect && longest > kLong * side && k % 2 == 1;
  const bool narrow = options_.free_aspect && !along && k % 4 == 2;
  double width = side * (1 + spread);
  if (along) width = longest * (1.1 + spread) + 1;
  if (narrow) width = side * (kNarrow + (1 - kNarrow) * double(k - 2) / double(count));
  return std::max(narrowest, static_cast<std::int32_t>(width));
}

PressStarts::Runner PressStarts::runner(std::size_t k, std::size_t count, std::uint32_t round,
                                        double work) const {
  Random random(options_.seed * 0x10001 + round * most_starts(options_) + k);
  const double shift = round > 0 ? 0.04 * (random.unit() - 0.5) : 0;
  NestSearchOptions search;
  search.width = strip_width(k, count, shift);
  search.seed = random.next();
  search.work = std::uint64_t(work);
  search.deadline = options_.deadline;
  // If there are only few charts, the search changes their order often enough.
  const LargestBy by = pieces_.size() < kManyCharts ? LargestBy::cells : LargestBy::boxes;
  return {NestSearch(pieces_, plan_by_size(pieces_, by), search), search.width, random.next(), {}};
}

void PressStarts::note(const NestSearchResult& found, Runner& runner) const {
  PressStart& start = runner.start;
  start.layouts = found.layouts;
  if (found.nest.left_over.empty()) take(found.nest, runner);
}

void PressStarts::take(const Nest& nest, Runner& runner) const {
  put_down(nest, runner.start);
  runner.start.page = {runner.width * double(cell_), nest.used_height * double(cell_)};
}

// Places a single chart in the direction in which its page is smallest.
PressStart PressStarts::alone() const {
  PressStart best;
  best.layouts = kTurns;
  const DrawnChart& d = drawn_[0];
  const Vec2d m = d.center_of_shape();
  for (int k = 0; k < kTurns; ++k) {
    const double angle = 0.5 * std::numbers::pi * k / kTurns;
    const double c = portable::cos(angle), s = portable::sin(angle), pad = options_.padding + 1;
    Vec2d low{1e300, 1e300}, high{-1e300, -1e300};
    const auto reach = [&](Vec2d p) {
      const Vec2d q{scale_ * p.x - m.x, scale_ * p.y - m.y};
      const Vec2d t{c * q.x - s * q.y, s * q.x + c * q.y};
      low = {std::min(low.x, t.x), std::min(low.y, t.y)};
      high = {std::max(high.x, t.x), std::max(high.y, t.y)};
    };
    for (const ChartOutline::Edge& e : outlines_[0].edges) reach(e.from);
    for (const auto& t : outlines_[0].loose) std::for_each(t.begin(), t.end(), reach);
    const SqueezePage page{high.x - low.x + 2 * pad, high.y - low.y + 2 * pad};
    if (goodness(page, options_) <= goodness(best.page, options_)) continue;
    best.page = page;
    best.poses = {{{pad - low.x, pad - low.y}, angle}};
  }
  return best;
}

// Turns a layout on cells into poses of the rigid bodies.
void PressStarts::put_down(const Nest& nest, PressStart& start) const {
  start.poses.resize(pieces_.size());
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const NestPlace& at = nest.places[i];
    if (!at.placed) continue;
    const double angle = 2 * std::numbers::pi * at.direction / kDirections;
    const double c = portable::cos(angle), s = portable::sin(angle);
    const Vec2d o = pieces_[i].origins[at.direction], m = drawn_[i].center_of_shape();
    start.poses[i] = {{at.at.x * double(cell_) + o.x + c * m.x - s * m.y,
                       at.at.y * double(cell_) + o.y + s * m.x + c * m.y},
                      angle};
  }
}

}  // namespace atlas::pack
