#include "libatlas/pack/fitting/fit_many.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "libatlas/core/parallel.h"
#include "libatlas/core/progress.h"
#include "libatlas/pack/fitting/fit_bounds.h"
#include "libatlas/pack/fitting/fit_factors.h"
#include "libatlas/pack/fitting/fit_result.h"
#include "libatlas/pack/nesting/grid_choice.h"
#include "libatlas/pack/nesting/nest.h"

namespace atlas::pack {
namespace {

// The share of the page that charts fill, for the first guess of the scale.
constexpr double kGuess = 0.62;
// A layout may examine this many words per chart. 4296 charts of a noisy terrain filled 0.61 of
// their page instead of 0.55 with 64 times the words that OutlineFit allows, because cells are
// finer. The search for a place begins where a chart of the same size was placed last, so it takes
// less than these words.
constexpr double kWordsFast = 45e3, kWords = 450e3, kWordsBest = 4.5e6;
// Directions that `best` tries if outlines may be turned by any angle.
constexpr std::uint32_t kDirectionsBest = 16;
// The number of layouts, each of which improves the guess of the scale. The strips are high enough
// from kNearlyFull on.
constexpr std::uint32_t kMostLayouts = 4, kMostGiven = 6;  // pages of any shape, of given shape
constexpr double kNearlyFull = 0.98;
// Copies of charts are laid in rows if they make up this share of the area. Fewer are of more use
// in the gaps between others.
constexpr double kRowsShare = 0.15;

struct ManyLayout {
  double scale = 0, fill = 0;
  std::int32_t height = 0;  // of the highest strip, in cells; 0: a chart found no room
  std::vector<FitPlacement> placements;
};

struct PagePlace {
  std::uint32_t page = 0;
  NestPlace place;
};

class ManyCharts {
 public:
  ManyCharts(const FitCharts& charts, const FitSearchOptions& options, const Context& context)
      : charts_(charts), options_(options), context_(context) {
    for (const ChartOutline& o : charts.outlines) area_ += o.area;
    const bool any_angle = options.allow_rotation && options.any_angle;
    find_ways(any_angle);
    const bool best = options.preset == PackPreset::best;
    const std::uint32_t rotations = options.allow_rotation
                                        ? (best && any_angle ? kDirectionsBest : options.rotations)
                                        : std::min(options.rotations, 1u);
    const double words = options.preset == PackPreset::fast ? kWordsFast
                         : best                             ? kWordsBest
                                                            : kWords;
    const std::size_t a_page = charts.items.size() / options.pages + 1;
    grid_ = choose_grid(
        {a_page, options.page_size, options.alignment, rotations, words * double(a_page), 0});
    side_ = options.page_size / grid_.cell;
    given_ = options.power_of_two && !options.free_aspect;
  }

  std::optional<FitResult> run() {
    const FitBounds bounds =
        fit_bounds(charts_.outlines, options_, side_ * grid_.cell, grid_.directions);
    if (bounds.gutters_exceed_pages || !(area_ > 0)) return std::nullopt;
    const double most = std::min(options_.max_scale, bounds.alone);
    const double pages = double(options_.page_size) * options_.page_size * options_.pages;
    const double guess = std::min({most, std::sqrt(kGuess * pages / area_), bounds.with_gutters});
    ManyLayout best;
    FitResult result;
    for (const Way& way : ways_) {
      improve(way, {guess, most}, best, result);
      if (context_.cancelled()) return std::nullopt;
      if (over() || (!options_.free_aspect && best.scale >= most)) break;
    }
    if (best.scale == 0) return std::nullopt;
    write(std::move(best), result);
    return result;
  }

 private:
  // Charts that are laid down as one piece.
  struct Way {
    std::vector<ChartPair> pairs;
    std::vector<RowPlan> rows;
    std::int32_t rows_a_page = 1;  // that lie side by side, at least
    std::vector<bool> joined;      // one per chart
  };

  struct Scales {
    double first = 0, most = 0;
  };

  // Looks for the largest scale in this way. Replaces `best` by what is better.
  void improve(const Way& way, Scales scales, ManyLayout& best, FitResult& result) const {
    double scale = scales.first;
    double low = 0, high = std::numeric_limits<double>::infinity();  // fits, and does not
    const std::uint32_t most_layouts = options_.free_aspect ? kMostLayouts : kMostGiven;
    for (std::uint32_t tried = 0; tried < most_layouts; ++tried) {
      ManyLayout layout = lay_out(way, scale);
      if (context_.cancelled() || layout.height == 0) return;
      const double height = layout.height;
      const bool fits = height <= side_;
      context_.report("packing", double(++result.packings) / double(ways_.size() * most_layouts));
      if (fits && (options_.free_aspect ? layout.fill > best.fill : scale > best.scale))
        best = std::move(layout);
      if (fits && (scale >= scales.most || height >= kNearlyFull * side_)) break;
      (fits ? low : high) = scale;
      constexpr double kSafe = 0.997;
      scale = std::min(scales.most, kSafe * scale * std::sqrt(side_ / height));
      if (!options_.free_aspect && (scale >= high || scale <= low)) scale = (low + high) / 2;
    }
  }

  bool over() const { return context_.cancelled() || wall_seconds() >= options_.deadline; }

  PieceOptions piece_options(std::span<const double> factors) const {
    PieceOptions options;
    options.factors = factors;
    options.padding = options_.padding;
    options.cell = grid_.cell;
    options.directions = grid_.directions;
    options.page = {side_, side_};
    options.keep_tests = false;  // each piece is placed once
    return options;
  }

  void find_joins() const {
    Joins& joins = *charts_.joins;
    if (joins.found) return;
    joins = {true, find_pairs(charts_.outlines, context_), find_rows(charts_.outlines, context_)};
  }

  // Joins charts in pairs, and if there are copies of charts, also in rows of several lengths.
  void find_ways(bool any_angle) {
    Way way;
    way.joined.assign(charts_.items.size(), false);
    if (any_angle) find_joins();
    way.pairs = charts_.joins->pairs;
    for (const ChartPair& p : way.pairs) way.joined[p.first] = way.joined[p.second] = true;
    ways_.push_back(way);
    way.rows = charts_.joins->rows;
    double in_rows = 0;
    for (const RowPlan& r : way.rows)
      in_rows += double(r.alike.charts.size()) * charts_.outlines[r.alike.charts[0]].area;
    if (in_rows < kRowsShare * area_) return;
    way.joined.assign(charts_.items.size(), false);
    for (const RowPlan& r : way.rows)
      for (const std::uint32_t i : r.alike.charts) way.joined[i] = true;
    std::erase_if(way.pairs,
                  [&](const ChartPair& p) { return way.joined[p.first] || way.joined[p.second]; });
    for (const ChartPair& p : way.pairs) way.joined[p.first] = way.joined[p.second] = true;
    for (const std::int32_t rows_a_page : {1, 2, 3}) {
      way.rows_a_page = rows_a_page;
      ways_.push_back(way);
    }
  }

  // Rasterises the charts that are not joined.
  std::vector<Piece> lone_pieces(const Way& way, std::span<const double> factors,
                                 std::vector<std::uint32_t>& lone) const {
    for (std::uint32_t i = 0; i < way.joined.size(); ++i) {
      if (!way.joined[i]) lone.push_back(i);
    }
    if (lone.empty()) return {};
    PieceOptions options = piece_options(factors);
    options.only = lone;
    return make_pieces(charts_.outlines, options, context_);
  }

  std::vector<JoinedPiece> joined_pieces(const Way& way, std::span<const double> factors) const {
    const ScaledCharts charts{charts_.outlines, factors};
    const PieceOptions common = piece_options({});
    std::vector<JoinedPiece> joined(way.pairs.size());
    parallel_for(context_, way.pairs.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        joined[k] = make_pair_piece(charts, way.pairs[k], common);
    });
    std::vector<std::vector<JoinedPiece>> rows(way.rows.size());
    parallel_for(context_, way.rows.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        rows[k] = make_row_pieces(charts, way.rows[k], common, side_ / way.rows_a_page);
    });
    for (std::vector<JoinedPiece>& group : rows)
      for (JoinedPiece& row : group) joined.push_back(std::move(row));
    return joined;
  }

  // Packs all charts at this scale into strips as wide as a page.
  ManyLayout lay_out(const Way& way, double scale) const {
    ManyLayout layout;
    layout.scale = scale;
    const std::vector<double> factors = chart_factors(charts_.items, options_, scale);
    std::vector<JoinedPiece> joined = joined_pieces(way, factors);
    std::vector<Piece> pieces;
    for (JoinedPiece& j : joined) pieces.push_back(std::move(j.piece));
    std::vector<std::uint32_t> lone;
    for (Piece& p : lone_pieces(way, factors, lone)) pieces.push_back(std::move(p));
    if (context_.cancelled()) return layout;
    const std::vector<PagePlace> places = fill_pages(pieces, layout);
    if (over()) layout.height = 0;  // pages may not have been filled
    if (layout.height == 0) return layout;
    const double cell = grid_.cell;
    layout.fill = scale * scale * area_ / (cell * cell * side_ * layout.height * options_.pages);
    layout.placements.resize(factors.size());
    for (std::size_t i = 0; i < factors.size(); ++i) layout.placements[i].scale = factors[i];
    for (std::size_t k = 0; k < joined.size(); ++k)
      for (const JoinedPart& part : joined[k].parts[places[k].place.direction])
        place(part, places[k], layout.placements[part.chart]);
    for (std::size_t k = 0; k < lone.size(); ++k) {
      const Piece& piece = pieces[joined.size() + k];
      const PagePlace& at = places[joined.size() + k];
      FitPlacement& out = layout.placements[lone[k]];
      if (piece.cells() == 0) {
        write_at_corner(charts_.outlines[lone[k]], out);
        continue;
      }
      const Mask& mask = piece.masks[at.place.direction];
      place({lone[k], 0, {0, 0, mask.width, mask.height}, piece.origins[at.place.direction]}, at,
            out);
    }
    return layout;
  }

  // Lays the pieces into one strip per page, largest first, each on the page whose pieces have the
  // fewest cells so far. Sets the height of the highest strip.
  std::vector<PagePlace> fill_pages(std::span<const Piece> pieces, ManyLayout& layout) const {
    std::vector<NestPlan> plans(options_.pages);
    std::vector<PagePlace> places(pieces.size());
    const NestPlan all = plan_by_size(pieces);
    const std::vector<std::uint32_t> pages = deal_out(pieces, all.order, options_.pages);
    for (const std::uint32_t i : all.order) {
      places[i].page = pages[i];
      plans[pages[i]].order.push_back(i);
    }
    const std::int32_t longest = longest_run(pieces);
    std::vector<std::int32_t> heights(options_.pages);
    parallel_for(context_, options_.pages, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        constexpr std::int32_t kHighest = 4;  // in sides of the page
        BitPage page(side_, kHighest * side_, longest);
        Nest nest;
        plans[p].direction = all.direction;
        plans[p].context = &context_;
        plans[p].deadline = options_.deadline;
        plans[p].all_or_none = true;
        place_pieces(pieces, plans[p], page, nest);
        heights[p] = nest.left_over.empty() ? std::max(1, nest.used_height) : 0;
        for (const std::uint32_t i : plans[p].order) places[i].place = nest.places[i];
      }
    });
    const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
    layout.height = *lowest > 0 ? *highest : 0;
    return places;
  }

  void place(const JoinedPart& part, const PagePlace& on, FitPlacement& out) const {
    const std::int32_t cell = grid_.cell;
    const NestPlace& at = on.place;
    out.page = on.page;
    const Rect box{(at.at.x + part.cells.x) * cell, (at.at.y + part.cells.y) * cell,
                   part.cells.width * cell, part.cells.height * cell};
    constexpr double kTurn = 2 * std::numbers::pi;
    const double angle =
        std::fmod(part.turn + kTurn * at.direction / grid_.directions + kTurn, kTurn);
    write_outline({box, angle, {box.x + part.origin.x, box.y + part.origin.y}}, options_, out);
  }

  void write(ManyLayout layout, FitResult& result) const {
    result.scale = layout.scale;
    result.layouts = result.packings;
    result.placements = std::move(layout.placements);
    const std::int32_t whole = side_ * grid_.cell;
    result.pages.assign(options_.pages, given_ ? Extent{whole, whole} : Extent{});
    double shapes = 0;
    for (std::size_t i = 0; i < result.placements.size(); ++i) {
      const FitPlacement& p = result.placements[i];
      shapes += charts_.outlines[i].area * p.scale * p.scale;
      if (!given_) enclose(p.box, options_, result.pages[p.page]);
    }
    drop_empty_pages(result);
    result.utilization = share_of_pages(shapes, result);
    if (options_.pages > 1) group(result);
  }

  // The pages are those of F(A) = N only if these happen to suit, but the result tells both.
  void group(FitResult& result) const {
    std::vector<std::uint64_t> cells;
    for (const FitPlacement& p : result.placements)
      cells.push_back(static_cast<std::uint64_t>(p.box.area()));
    group_areas(cells, options_.pages, context_, result.grouping);
  }

  const FitCharts charts_;
  const FitSearchOptions& options_;
  const Context& context_;
  std::vector<Way> ways_;
  GridChoice grid_;
  bool given_ = false;     // pages keep their size
  std::int32_t side_ = 0;  // in cells
  double area_ = 0;        // of all charts at scale 1
};

}  // namespace

std::optional<FitResult> fit_many(const FitCharts& charts, const FitSearchOptions& options,
                                  const Context& context) {
  return ManyCharts(charts, options, context).run();
}

}  // namespace atlas::pack
