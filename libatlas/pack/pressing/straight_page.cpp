#include "libatlas/pack/pressing/straight_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libatlas/core/parallel.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/random.h"
#include "libatlas/pack/nesting/nest.h"
#include "libatlas/pack/nesting/overlap_search.h"
#include "libatlas/pack/nesting/slide.h"

namespace atlas::pack {
namespace {

// More cells gain more than more layouts do: between straight sides, only the rounding to cells is
// lost. Halving the number costs a quarter to half a percentage point of the page.
constexpr int kCellsASide = 512;
// Starts of a round; the fullest kSlidStarts are made lower by letting charts overlap for a while.
// Thirteen sets of charts filled 0.808 of their pages with these numbers and 0.813 with 16 starts,
// 4 of them made lower, in three and a half times the time.
constexpr std::size_t kStarts = 12, kSlidStarts = 2;
// Up to kFewStraightCharts charts get kLowStarts more starts, whose pages are lower. A few charts
// may only nest in one row: four U shapes that interlock in pairs fill 0.72 of a page of 2 : 1, and
// 0.52 of pages that are higher.
constexpr std::size_t kFewStraightCharts = 16, kLowStarts = 4;
// Shares of a round's work: searching for orders of placing charts, and letting charts overlap.
constexpr double kStraightOrders = 0.4, kStraightOverlaps = 0.4;
constexpr int kStraightSlides = 2;  // down and left; a third slide gains nothing
constexpr std::uint32_t kQuarterTurns = 4;

// A layout on cells. At the same scale, the masks on cells cover the exact masks.
struct Start {
  double scale = 0, fill = 0;
  std::int32_t height = 0;        // in cells
  std::vector<NestPlace> places;  // one per chart
  // Origins of the masks on cells, in the direction in which they are placed.
  std::vector<Vec2d> origins;
  std::uint64_t layouts = 0, seed = 1;
};

// The charts at their exact places.
class Slider {
 public:
  Slider(std::vector<Piece> pieces, const Start& start, const FitOptions& options,
         std::int32_t cell)
      : pieces_(std::move(pieces)), start_(start), unit_(options.alignment) {
    std::int32_t top = 0;
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      const NestPlace& p = start.places[i];
      const Mask& mask = pieces_[i].masks[p.direction];
      if (mask.cells == 0) continue;
      // Both masks hold the same padded chart, so their corners differ by the difference of their
      // origins.
      const Vec2d coarse = start.origins[i], exact = pieces_[i].origins[p.direction];
      const BitPage::Place at{cells(p.at.x * double(cell) + coarse.x - exact.x),
                              cells(p.at.y * double(cell) + coarse.y - exact.y)};
      masks_.push_back({&mask, at, i});
      top = std::max(top, at.y + mask.height);
    }
    // Charts move down only, except for one cell.
    page_ = PlainPage(options.page_size / unit_, top + 1);
  }

  // Puts the charts on the page. Returns false if a chart has no room although its mask on cells
  // had some: outlines that are thinned for the cells may lack a corner.
  bool put_down() {
    for (SlidingMask& m : masks_) {
      if (!nearest_free(m)) return false;
      page_.put(*m.mask, m.at);
    }
    return true;
  }

  void slide_to(BitPage::Place step) { slide(step, page_, masks_); }

  PressedPage result() const {
    PressedPage page;
    page.scale = start_.scale;
    page.places.assign(pieces_.size(), {});
    for (const SlidingMask& m : masks_) {
      PressedPlace& p = page.places[m.chart];
      const std::uint32_t direction = start_.places[m.chart].direction;
      const Vec2d origin = pieces_[m.chart].origins[direction];
      p.placed = true;
      p.angle = 2 * std::numbers::pi * direction / kQuarterTurns;
      p.box = {m.at.x * unit_, m.at.y * unit_, m.mask->width * unit_, m.mask->height * unit_};
      p.offset = {p.box.x + origin.x, p.box.y + origin.y};
      page.page.width = std::max(page.page.width, p.box.right());
      page.page.height = std::max(page.page.height, p.box.top());
    }
    return page;
  }

 private:
  std::int32_t cells(double texels) const { return std::int32_t(std::lround(texels / unit_)); }

  bool nearest_free(SlidingMask& m) {
    constexpr std::array<std::int32_t, 3> kNear{0, -1, 1};
    const BitPage::Place wanted = m.at;
    for (const std::int32_t dy : kNear)
      for (const std::int32_t dx : kNear) {
        m.at = {wanted.x + dx, wanted.y + dy};
        if (is_free_at(m, m.at, page_)) return true;
      }
    return false;
  }

  std::vector<Piece> pieces_;
  const Start& start_;
  std::int32_t unit_;
  PlainPage page_;
  std::vector<SlidingMask> masks_;  // of the charts that have a mask
};

class StraightPage {
 public:
  StraightPage(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
               const Context& context)
      : outlines_(outlines),
        options_(options),
        context_(context),
        cell_(std::max(1, options.page_size / kCellsASide / options.alignment) *
              options.alignment) {
    for (const ChartOutline& o : outlines) {
      area_ += o.area;
      longest_ = std::max(longest_, long_side(o));
    }
  }

  PressedPage run() {
    PressedPage best;
    SearchRounds rounds(options_, outlines_.size());
    while (!context_.cancelled() && rounds.next()) {
      const std::size_t all = kStarts + (outlines_.size() <= kFewStraightCharts ? kLowStarts : 0);
      std::vector<Start> starts(layouts_of_round(all, rounds.share()));
      const double work = kStraightOrders * rounds.share() * round_work(outlines_.size()) /
                          (double(starts.size()) * kWordsOfPlacing);
      parallel_for(context_, starts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          starts[k] = start(k * all / starts.size(), rounds.number(), work);
      });
      for (const Start& s : starts) best.layouts += s.layouts;
      const std::size_t slid = layouts_of_round(kSlidStarts, rounds.share());
      lower_fullest(starts, slid, rounds.share());
      slide_fullest(starts, slid, best);
      context_.report("packing", 1 - 1 / (rounds.number() + 2.0));
    }
    return best;
  }

 private:
  static double long_side(const ChartOutline& outline) {
    const Vec2d box = box_of(outline, 0);
    return std::max(box.x, box.y);
  }

  // Returns the scale of start k. The page is as wide as allowed, and the scale decides how high it
  // becomes: from a square down to 0.6 of that, or 0.4 for the additional starts. If charts are
  // nearly as long as the page at this scale, or longer, they lie along the page, and the scale is
  // one at which they fit.
  double scale_of(std::size_t k, double shift) const {
    constexpr double kStraightFill = 0.74, kLowest = 0.6, kFewLowest = 0.4, kNearlyAsLong = 0.8;
    const bool low = k >= kStarts;
    const double share =
        low ? double(k + 1 - kStarts) / double(kLowStarts) : double(k) / double(kStarts - 1);
    const double at = std::clamp(share + shift, 0.0, 1.0);
    const double side = options_.page_size;
    const double height = low ? kLowest - (kLowest - kFewLowest) * at : 1 - (1 - kLowest) * at;
    const double scale = std::sqrt(kStraightFill * side * side * height / area_);
    const double most =
        (side - 2 * (options_.padding + options_.alignment)) / std::max(longest_, 1e-300);
    return scale < kNearlyAsLong * most ? scale : most * (1 - (1 - kNearlyAsLong) * at);
  }

  Start start(std::size_t k, std::uint32_t round, double work) const {
    Random random(options_.seed * 0x10001 + round * (kStarts + kLowStarts) + k);
    Start start;
    start.scale = scale_of(k, round > 0 ? 0.06 * (random.unit() - 0.5) : 0);
    if (!(start.scale > 0)) return start;  // the gutters take the whole page
    const std::vector<Piece> pieces = pieces_at(start.scale, cell_);
    NestSearchOptions search;
    search.width = options_.page_size / cell_;
    search.seed = random.next();
    search.work = std::uint64_t(work);
    search.deadline = options_.deadline;
    NestSearchResult found = search_nest(pieces, plan_by_size(pieces), search, context_);
    start.layouts = found.layouts;
    start.seed = random.next();
    if (found.nest.left_over.empty() && found.nest.used_height > 0)
      take(std::move(found.nest), pieces, start);
    return start;
  }

  void take(Nest nest, std::span<const Piece> pieces, Start& start) const {
    start.height = nest.used_height;
    start.fill =
        start.scale * start.scale * area_ / (double(options_.page_size) * nest.used_height * cell_);
    start.origins.resize(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (nest.places[i].placed) start.origins[i] = pieces[i].origins[nest.places[i].direction];
    start.places = std::move(nest.places);
  }

  // Sorts the starts, fullest first, and makes the first of them lower than any order of placing
  // charts does.
  void lower_fullest(std::vector<Start>& starts, std::size_t count, double share) const {
    sort(starts);
    parallel_for(context_, count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Start& s = starts[k];
        if (s.fill == 0) continue;
        const std::vector<Piece> pieces = pieces_at(s.scale, cell_);
        if (context_.cancelled()) return;  // pieces may not have been rasterised
        Nest nest;
        nest.places = s.places;
        nest.used_height = s.height;
        OverlapSearchOptions overlap;
        overlap.width = options_.page_size / cell_;
        overlap.work =
            std::uint64_t(kStraightOverlaps * share * round_work(outlines_.size()) / double(count));
        overlap.deadline = options_.deadline;
        overlap.seed = s.seed;
        search_overlaps(pieces, overlap, context_, nest);
        take(std::move(nest), pieces, s);
      }
    });
    sort(starts);
  }

  static void sort(std::vector<Start>& starts) {
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Start& a, const Start& b) { return a.fill > b.fill; });
  }

  std::vector<Piece> pieces_at(double scale, std::int32_t cell) const {
    PieceOptions pieces;
    pieces.factor = scale;
    pieces.padding = options_.padding;
    pieces.cell = cell;
    pieces.directions = kQuarterTurns;
    if (cell == options_.alignment) return make_pieces(outlines_, pieces, context_);
    std::vector<ChartOutline> thin;
    for (const ChartOutline& o : outlines_) thin.push_back(thinned(o, 0.125 * cell / scale));
    return make_pieces(thin, pieces, context_);
  }

  void slide_fullest(std::vector<Start>& starts, std::size_t count, PressedPage& best) const {
    for (std::size_t k = 0; k < starts.size() && count > 0 && !context_.cancelled(); ++k) {
      const Start& s = starts[k];
      if (s.fill == 0) return;
      std::vector<Piece> pieces = pieces_at(s.scale, options_.alignment);
      if (context_.cancelled()) return;  // pieces may not have been rasterised
      Slider slider(std::move(pieces), s, options_, cell_);
      if (!slider.put_down()) continue;
      for (int slide = 0; slide < kStraightSlides; ++slide) {
        slider.slide_to({0, -1});
        slider.slide_to({-1, 0});
      }
      const PressedPage page = slider.result();
      if (page.page.height > options_.page_size) continue;
      --count;
      if (fill(page) <= fill(best)) continue;
      best.scale = page.scale;
      best.page = page.page;
      best.places = page.places;
    }
  }

  double fill(const PressedPage& p) const {
    return p.scale > 0 ? p.scale * p.scale * area_ / double(p.page.area()) : 0;
  }

  std::span<const ChartOutline> outlines_;
  const FitSearchOptions& options_;
  const Context& context_;
  std::int32_t cell_;
  double area_ = 0, longest_ = 0;
};

}  // namespace

bool is_straight(std::span<const ChartOutline> outlines) {
  // Of the sets of charts that were measured, straight ones had 70 % or more of their length along
  // the axes, and all others less than 35 %.
  constexpr double kAlong = 0.02, kShare = 0.45;
  double all = 0, along = 0;
  for (const ChartOutline& o : outlines)
    for (const ChartOutline::Edge& e : o.edges) {
      const double x = std::abs(e.to.x - e.from.x), y = std::abs(e.to.y - e.from.y);
      const double length = portable::hypot(x, y);
      all += length;
      if (std::min(x, y) <= kAlong * length) along += length;
    }
  return along > kShare * all;
}

PressedPage pack_straight(std::span<const ChartOutline> outlines, const FitSearchOptions& options,
                          const Context& context) {
  return StraightPage(outlines, options, context).run();
}

}  // namespace atlas::pack
