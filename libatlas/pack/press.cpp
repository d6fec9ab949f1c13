#include "libatlas/pack/press.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/pack/engines.h"
#include "libatlas/pack/nest.h"
#include "libatlas/pack/settle.h"
#include "libatlas/pack/squeeze.h"

namespace atlas::pack {
namespace {

// Page fill at which the search begins; only the ratio of charts to gutters depends on it.
constexpr double kExpectedFill = 0.8;
// A page emptier than this, as a third of those measured are, is drawn a second time: the emptiest
// gain one to two points by it, while more starts for all would win a tenth of that in the same
// time. One that is emptier still is drawn a third time.
constexpr double kPoorFill = 0.715, kPoorerFill = 0.70;
// By what further draws raised a page's fill at most.
constexpr double kMostRedrawn = 1.06;
// Cells across a page: at first, of many charts, and when drawn again. Finer cells lose less of the
// gaps between charts with narrow limbs, and take longer.
constexpr int kCells = 128, kCellsOfMany = 192, kFineCells = 256;
constexpr std::size_t kManyCharts = 48;
constexpr double kMostSides = 2;        // of the page, drawn: the longest chart
constexpr double kMostCells = 1 << 21;  // of the finest grid under one chart's box

constexpr std::size_t kMostCharts = 128;
constexpr std::size_t kStartedCharts = 480;  // over all starts: fewer charts get more of them
constexpr std::size_t kMostStarts = 20;
constexpr std::uint64_t kSearchWork = 160'000'000;  // words looked at by all starts, 2 ns each
constexpr std::uint64_t kLayouts = 32;              // of one start
constexpr std::uint32_t kMostDoublings = 4;         // of both, a round of `best` each
constexpr std::uint32_t kDirections = 24;
// Few are worth pressing: what a start's cells say about its page is nearly what the press makes of
// it. What the time of more of them buys is less than that of more layouts.
constexpr std::size_t kRoughStarts = 4, kThoroughStarts = 2;
constexpr std::size_t kCoarse = 0, kFine = 1;

struct Effort {
  double first_step, last_step;
  std::uint32_t sweeps;
};
constexpr Effort kRough{0.015, 0.006, 500}, kThorough{0.008, 0.003, 2000},
    kPolish{0.002, 0.0008, 600};

// A chart in the frame of its mask at scale scale_: shape point p is at origin + scale_ p.
struct Drawn {
  Vec2d origin;
  Body bodies[2];  // kCoarse, kFine

  // In texels from the shape's own origin.
  Vec2d center_of_shape() const {
    const Vec2d c = bodies[kCoarse].center;
    return {c.x - origin.x, c.y - origin.y};
  }
};

// One layout pushed together.
struct Start {
  std::vector<std::pair<Vec2d, double>> poses;  // 1 a chart: centre and angle
  SqueezePage page;
  std::uint64_t layouts = 0;
};

class Press {
 public:
  Press(std::span<const ChartOutline> outlines, const FitOptions& options, const Context& context)
      : outlines_(outlines), options_(options), context_(context) {
    for (const ChartOutline& o : outlines) area_ += o.area;
    const double page = double(options.page_size) * options.page_size;
    double longest = 0;
    for (const ChartOutline& o : outlines) {
      const Vec2d box = box_of(o, 0);
      longest = std::max({longest, box.x, box.y});
    }
    // What is longer will lie along the page, far smaller than its area tells.
    const double by_area = std::sqrt(kExpectedFill * page / area_);
    scale_ = std::min(by_area, kMostSides * options.page_size / longest);
    side_ = options.page_size * (scale_ / by_area);
    draw();
    draw_pieces(outlines.size() < kManyCharts ? kCells : kCellsOfMany);
  }

  PressedPage run() {
    PressedPage best;
    const double begun = wall_seconds();
    const std::size_t n = std::max<std::size_t>(1, outlines_.size());
    const std::size_t count =
        n == 1 ? 1 : std::clamp<std::size_t>(kStartedCharts / n, 1, kMostStarts);
    for (std::uint32_t round = 0; !context_.cancelled(); ++round) {
      std::vector<Start> starts(count);
      parallel_for(context_, count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) starts[k] = start(k, count, round);
      });
      for (const Start& s : starts) best.layouts += s.layouts;
      if (n > 1) {
        press_best(starts, kRoughStarts, kRough);
        press_best(starts, kThoroughStarts, kThorough);
      }
      settle_best(starts, best);
      const double done = book_round(options_, wall_seconds() - begun, fill(best), best);
      if (n == 1) break;
      const bool best_wanted = options_.preset == PackPreset::best;
      // Starts are drawn by chance: an empty page deserves a second draw.
      if (!best_wanted && !worth_another_draw(round, fill(best))) break;
      if (round == 0) draw_pieces(kFineCells);
      if (!best_wanted) continue;
      if (!(done < 1)) break;
      context_.report("pack", done);
    }
    return best;
  }

 private:
  bool worth_another_draw(std::uint32_t round, double fill) const {
    return round < 2 && fill < (round > 0 ? kPoorerFill : kPoorFill) &&
           kMostRedrawn * fill >= options_.wanted_fill;
  }

  // The search needs outlines only as fine as its cells; exact masks come last.
  void draw() {
    const int fine = std::max(1, options_.page_size / 1024);
    const std::size_t n = outlines_.size();
    drawn_.resize(n);
    parallel_for(context_, n, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) draw_one(i, fine);
    });
  }

  // The pieces of the search, so many cells across the page.
  void draw_pieces(int cells) {
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

  void draw_one(std::size_t i, int fine) {
    Drawn& d = drawn_[i];
    const Vec2d box = box_of(outlines_[i], 0);
    while (scale_ * box.x * scale_ * box.y > kMostCells * fine * fine) fine *= 2;
    RasterOptions raster;
    raster.factor = scale_;
    raster.padding = 0;
    raster.cell = fine;
    const Mask mask = rasterize(outlines_[i], raster, d.origin);
    if (mask.cells == 0) return;
    const double cell = fine;
    d.bodies[kCoarse] = make_body(coarsen(mask, 4), 4 * cell, 12 * cell, 10 * cell);
    d.bodies[kFine] = make_body(coarsen(mask, 2), 2 * cell, 8 * cell, 2 * cell);
    // One centre for both.
    const Vec2d shift{d.bodies[kFine].center.x - d.bodies[kCoarse].center.x,
                      d.bodies[kFine].center.y - d.bodies[kCoarse].center.y};
    for (Vec2d& q : d.bodies[kFine].outline) q = {q.x + shift.x, q.y + shift.y};
    make_arcs(d.bodies[kFine]);
    d.bodies[kFine].center = d.bodies[kCoarse].center;
    d.bodies[kFine].radius += std::hypot(shift.x, shift.y);
  }

  static constexpr double kLong = 1.2, kNarrow = 0.4;

  // Strips of widths around the square page's side. Where pages may have any shape, every fourth is
  // narrower, for few large charts may fill it in one row, and if a chart is longer than the side,
  // every second lays it along the strip.
  std::int32_t strip_width(std::size_t k, std::size_t count, double shift) const {
    const double side = side_ * std::sqrt(kExpectedFill / 0.69) / cell_;
    const double spread = (count > 1 ? 0.2 * double(k) / double(count - 1) - 0.1 : 0) + shift;
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
    const bool narrow = options_.free_aspect && !along && k % 4 == 0;
    double width = side * (1 + spread);
    if (along) width = longest * (1.1 + spread) + 1;
    if (narrow) width = side * (kNarrow + (1 - kNarrow) * double(k) / double(count));
    return std::max(narrowest, static_cast<std::int32_t>(width));
  }

  Start start(std::size_t k, std::size_t count, std::uint32_t round) const {
    Random random(options_.seed * 0x10001 + round * kMostStarts + k);
    const double shift = round > 0 ? 0.04 * (random.unit() - 0.5) : 0;
    NestSearchOptions search;
    search.width = strip_width(k, count, shift);
    search.seed = random.next();

    const std::uint32_t doublings =
        options_.preset == PackPreset::best ? std::min(round, kMostDoublings) : 0;
    search.work = kSearchWork / count << doublings;
    search.layouts = kLayouts << doublings;
    Start start;
    if (pieces_.size() == 1) return alone();
    const auto [nest, layouts] = search_nest(pieces_, plan_by_size(pieces_), search, context_);
    start.layouts = layouts;
    if (!nest.left_over.empty()) return start;
    put_down(nest, start);
    start.page = {search.width * double(cell_), nest.used_height * double(cell_)};
    return start;
  }

  // The starts whose pages are smallest, each pushed together.
  void press_best(std::vector<Start>& starts, std::size_t most, const Effort& effort) const {
    sort_starts(starts);
    parallel_for(context_, std::min(most, starts.size()), 1,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t k = begin; k < end; ++k)
                     if (!starts[k].poses.empty() && goodness(starts[k].page) > 0)
                       push_together(kCoarse, squeeze_options(starts[k].page, effort), starts[k]);
                 });
  }

  // A single chart, turned such that its page is small.
  Start alone() const {
    Start best;
    best.layouts = kTurns;
    const Drawn& d = drawn_[0];
    const Vec2d m = d.center_of_shape();
    for (int k = 0; k < kTurns; ++k) {
      const double angle = 0.5 * std::numbers::pi * k / kTurns;
      const double c = std::cos(angle), s = std::sin(angle), pad = options_.padding + 1;
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
      if (goodness(page) <= goodness(best.page)) continue;
      best.page = page;
      best.poses = {{{pad - low.x, pad - low.y}, angle}};
    }
    return best;
  }
  static constexpr int kTurns = 180;

  // From cells to rigid bodies.
  void put_down(const Nest& nest, Start& start) const {
    start.poses.resize(pieces_.size());
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const NestPlace& at = nest.places[i];
      if (!at.placed) continue;
      const double angle = 2 * std::numbers::pi * at.direction / kDirections;
      const double c = std::cos(angle), s = std::sin(angle);
      const Vec2d o = pieces_[i].origins[at.direction], m = drawn_[i].center_of_shape();
      start.poses[i] = {{at.at.x * double(cell_) + o.x + c * m.x - s * m.y,
                         at.at.y * double(cell_) + o.y + s * m.x + c * m.y},
                        angle};
    }
  }

  // The page's longer side will be the largest allowed: a texel of it is `texel` of the bodies'.
  SqueezeOptions squeeze_options(const SqueezePage& page, const Effort& effort) const {
    SqueezeOptions options;
    options.first_step = effort.first_step;
    options.last_step = effort.last_step;
    options.sweeps = effort.sweeps;
    const double texel = std::max(page.width, page.height) / options_.page_size;
    options.clearance = texel * (2 * options_.padding + 0.8 * options_.alignment);
    options.margin = texel * (options_.padding + 0.2 * options_.alignment);
    options.tolerance = texel * 0.5 * options_.alignment;
    options.square = !options_.free_aspect;
    return options;
  }

  void push_together(std::size_t level, const SqueezeOptions& options, Start& start) const {
    std::vector<Body> bodies;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
      if (outlines_[i].empty()) continue;
      bodies.push_back(drawn_[i].bodies[level]);
      bodies.back().at = start.poses[i].first;
      bodies.back().angle = start.poses[i].second;
      owner.push_back(i);
    }
    start.page = squeeze(bodies, start.page, options);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      start.poses[owner[b]] = {bodies[b].at, bodies[b].angle};
  }

  double goodness(const SqueezePage& page) const {
    if (!(page.width > 0)) return 0;
    return 1 / (options_.free_aspect ? page.width * page.height
                                     : std::pow(std::max(page.width, page.height), 2));
  }

  double fill(double scale, double width, double height) const {
    if (!options_.free_aspect) width = height = std::max(width, height);
    return width > 0 ? scale * scale * area_ / (width * height) : 0;
  }
  double fill(const PressedPage& page) const {
    const double side = options_.page_size;
    return options_.free_aspect ? fill(page.scale, page.page.width, page.page.height)
                                : fill(page.scale, side, side);
  }

  void sort_starts(std::vector<Start>& starts) const {
    std::stable_sort(starts.begin(), starts.end(), [&](const Start& a, const Start& b) {
      return goodness(a.page) > goodness(b.page);
    });
  }

  // The fullest start is pressed once more with finer outlines and placed exactly, and the next
  // where that fails, or where charts are so few that chance decides which of two comes out fuller.
  void settle_best(std::vector<Start>& starts, PressedPage& best) const {
    constexpr std::size_t kFew = 16, kMost = 6;
    constexpr double kClose = 0.99;  // one emptier than this share of the fullest never does
    sort_starts(starts);
    const double fullest = goodness(starts.front().page);
    bool settled = false;
    std::size_t wanted = outlines_.size() <= kFew ? kThoroughStarts : 1;
    for (std::size_t k = 0; k < std::min(starts.size(), kMost) && wanted > 0; ++k) {
      if (context_.cancelled()) return;
      if (settled && goodness(starts[k].page) < kClose * fullest) return;
      if (!settle_start(starts[k], best)) continue;
      settled = true;
      --wanted;
    }
  }

  // Exact masks reach up to a cell beyond the bodies. Where charts lie in each other's notches and
  // little of the page's fill is left for that, bodies with more room around them do better.
  bool settle_start(Start& s, PressedPage& best) const {
    constexpr double kMostLost = 0.03;         // of the fill
    constexpr std::array kMoreRoom{0.0, 0.8};  // alignments
    bool settled = false;
    for (const double more : kMoreRoom) {
      if (s.poses.empty() || goodness(s.page) == 0) return settled;
      SqueezeOptions polish = squeeze_options(s.page, kPolish);
      polish.clearance += more * options_.alignment;
      const SqueezePage before = s.page;
      push_together(kFine, polish, s);
      const bool polished = goodness(s.page) > 0;
      if (!polished) s.page = before;  // finer outlines overlap too much: as they were
      const double pressed = fill(scale_, s.page.width, s.page.height);
      const PressedPage page = settle_exactly(s);
      settled = settled || page.scale > 0;
      if (fill(page) > fill(best)) take(page, best);
      if (!polished || fill(page) > (1 - kMostLost) * pressed) break;
    }
    return settled;
  }

  static void take(const PressedPage& page, PressedPage& best) {
    best.scale = page.scale;
    best.page = page.page;
    best.places = page.places;
    best.targets = page.targets;
    best.target_scale = page.target_scale;
  }

  PressedPage settle_exactly(const Start& s) const {
    const double grow = options_.page_size / std::max(s.page.width, s.page.height);
    std::vector<SettleTarget> targets(s.poses.size());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const Vec2d center = drawn_[i].center_of_shape();
      targets[i].origin = {s.poses[i].first.x * grow, s.poses[i].first.y * grow};
      targets[i].angle = s.poses[i].second;
      targets[i].from = {-center.x / scale_, -center.y / scale_};
    }
    PressedPage page = settle({targets, scale_ * grow}, outlines_, options_, context_);
    page.targets = std::move(targets);
    page.target_scale = scale_ * grow;
    return page;
  }

  std::span<const ChartOutline> outlines_;
  const FitOptions& options_;
  const Context& context_;
  double area_ = 0, scale_ = 1;
  double side_ = 0;  // of a square page that the charts as drawn fill to kExpectedFill, texels
  std::int32_t cell_ = 1;
  std::vector<Drawn> drawn_;
  std::vector<Piece> pieces_;
};

}  // namespace

double book_round(const FitOptions& options, double seconds, double use, PressedPage& best) {
  if (best.scale > 0 && (best.curve.empty() || best.curve.back().utilization < use))
    best.curve.push_back({seconds, best.layouts, use});
  return options.effort > 0 ? double(best.layouts) / double(options.effort)
                            : seconds / options.time_budget;
}

bool worth_pressing(std::span<const ChartOutline> outlines, const FitOptions& options) {
  constexpr double kSurelyFits = 0.5;  // at the largest scale: the page may even be smaller
  const double page = double(options.page_size) * options.page_size;
  double area = 0;
  for (const ChartOutline& o : outlines) area += o.area;
  return options.pages == 1 && options.preset != PackPreset::fast && options.any_angle &&
         options.allow_rotation && options.page_size >= 256 && outlines.size() <= kMostCharts &&
         area > 0 && options.max_scale * options.max_scale * area > kSurelyFits * page;
}

PressedPage press_outlines(std::span<const ChartOutline> outlines, const FitOptions& options,
                           const Context& context) {
  return Press(outlines, options, context).run();
}

}  // namespace atlas::pack
