#include "libatlas/pack/fit_free_page.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libatlas/core/parallel.h"
#include "libatlas/core/progress.h"
#include "libatlas/pack/fit_bounds.h"
#include "libatlas/pack/fit_factors.h"
#include "libatlas/pack/fit_result.h"
#include "libatlas/pack/nest.h"
#include "libatlas/pack/pairs.h"
#include "libatlas/pack/shape_check.h"

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
// The number of layouts, each of which improves the guess of the scale. The page is high enough
// from kNearlyFull on.
constexpr std::uint32_t kMostLayouts = 4;
constexpr double kNearlyFull = 0.98;

struct FreeLayout {
  double scale = 0, fill = 0;
  std::int32_t height = 0;  // in cells; 0: a chart found no room
  std::vector<FitPlacement> placements;
};

class FreePage {
 public:
  FreePage(const FitCharts& charts, const FitOptions& options, const Context& context)
      : charts_(charts), options_(options), context_(context) {
    for (const ChartOutline& o : charts.outlines) area_ += o.area;
    const bool any_angle = options.allow_rotation && options.any_angle;
    if (any_angle) pairs_ = find_pairs(charts.outlines, context);
    paired_.assign(charts.items.size(), false);
    for (const ChartPair& p : pairs_) paired_[p.first] = paired_[p.second] = true;
    const bool best = options.preset == PackPreset::best;
    const std::uint32_t rotations = options.allow_rotation
                                        ? (best && any_angle ? kDirectionsBest : options.rotations)
                                        : std::min(options.rotations, 1u);
    const double words = options.preset == PackPreset::fast ? kWordsFast
                         : best                             ? kWordsBest
                                                            : kWords;
    grid_ = choose_grid({charts.items.size(), options.page_size, options.alignment, rotations,
                         words * double(charts.items.size()), 0});
    side_ = options.page_size / grid_.cell;
  }

  std::optional<FitResult> run() {
    const FitBounds bounds =
        fit_bounds(charts_.outlines, options_, side_ * grid_.cell, grid_.directions);
    if (bounds.gutters_exceed_pages || !(area_ > 0)) return std::nullopt;
    const double most = std::min(options_.max_scale, bounds.alone);
    const double page = double(options_.page_size) * options_.page_size;
    double scale = std::min({most, std::sqrt(kGuess * page / area_), bounds.with_gutters});
    FreeLayout best;
    FitResult result;
    while (result.packings < kMostLayouts) {
      FreeLayout layout = lay_out(scale);
      if (context_.cancelled() || layout.height == 0) return std::nullopt;
      const double height = layout.height;
      const bool fits = height <= side_;
      context_.report("packing", double(++result.packings) / kMostLayouts);
      if (fits && layout.fill > best.fill) best = std::move(layout);
      if (fits && (scale >= most || height >= kNearlyFull * side_)) break;
      constexpr double kSafe = 0.997;
      scale = std::min(most, kSafe * scale * std::sqrt(side_ / height));
    }
    if (best.scale == 0) return std::nullopt;
    write(std::move(best), result);
    return result;
  }

 private:
  PieceOptions piece_options(std::span<const double> factors) const {
    PieceOptions options;
    options.factors = factors;
    options.padding = options_.padding;
    options.cell = grid_.cell;
    options.directions = grid_.directions;
    options.page = {side_, side_};
    return options;
  }

  // Rasterises the charts that are not paired.
  std::vector<Piece> lone_pieces(std::span<const double> factors,
                                 std::vector<std::uint32_t>& lone) const {
    std::vector<ChartOutline> outlines;
    std::vector<double> own_factors;
    for (std::uint32_t i = 0; i < paired_.size(); ++i) {
      if (paired_[i]) continue;
      lone.push_back(i);
      outlines.push_back(charts_.outlines[i]);
      own_factors.push_back(factors[i]);
    }
    return make_pieces(outlines, piece_options(own_factors), context_);
  }

  // Packs all charts at this scale into a strip as wide as the page.
  FreeLayout lay_out(double scale) const {
    FreeLayout layout;
    layout.scale = scale;
    const std::vector<double> factors = chart_factors(charts_.items, options_, scale);
    std::vector<PairPiece> joined(pairs_.size());
    const PieceOptions common = piece_options({});
    parallel_for(context_, pairs_.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const ChartPair& p = pairs_[k];
        joined[k] = make_pair_piece({charts_.outlines, factors}, p, common);
      }
    });
    std::vector<Piece> pieces;
    for (PairPiece& j : joined) pieces.push_back(std::move(j.piece));
    std::vector<std::uint32_t> lone;
    for (Piece& p : lone_pieces(factors, lone)) pieces.push_back(std::move(p));
    if (context_.cancelled()) return layout;
    constexpr std::int32_t kHighest = 4;  // in sides of the page
    BitPage page(side_, kHighest * side_, longest_run(pieces));
    Nest nest;
    NestPlan plan = plan_by_size(pieces);
    plan.cancel = context_.cancel;
    place_pieces(pieces, plan, page, nest);
    if (context_.cancelled() || !nest.left_over.empty()) return layout;
    layout.height = std::max(1, nest.used_height);
    const double cell = grid_.cell;
    layout.fill = scale * scale * area_ / (cell * cell * side_ * layout.height);
    layout.placements.resize(factors.size());
    for (std::size_t i = 0; i < factors.size(); ++i) layout.placements[i].scale = factors[i];
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto& [first, second] = joined[k].parts[nest.places[k].direction];
      place(first, 0, nest.places[k], layout.placements[pairs_[k].first]);
      place(second, pairs_[k].turn, nest.places[k], layout.placements[pairs_[k].second]);
    }
    for (std::size_t k = 0; k < lone.size(); ++k) {
      const Piece& piece = pieces[pairs_.size() + k];
      const NestPlace& at = nest.places[pairs_.size() + k];
      FitPlacement& out = layout.placements[lone[k]];
      if (piece.cells() == 0) {
        write_at_corner(charts_.outlines[lone[k]], out);
        continue;
      }
      const Mask& mask = piece.masks[at.direction];
      place({{0, 0, mask.width, mask.height}, piece.origins[at.direction]}, 0, at, out);
    }
    return layout;
  }

  void place(const PairPart& part, double turn, const NestPlace& at, FitPlacement& out) const {
    const std::int32_t cell = grid_.cell;
    const Rect box{(at.at.x + part.cells.x) * cell, (at.at.y + part.cells.y) * cell,
                   part.cells.width * cell, part.cells.height * cell};
    constexpr double kTurn = 2 * std::numbers::pi;
    const double angle = std::fmod(turn + kTurn * at.direction / grid_.directions + kTurn, kTurn);
    write_outline({box, angle, {box.x + part.origin.x, box.y + part.origin.y}}, options_, out);
  }

  void write(FreeLayout layout, FitResult& result) const {
    result.scale = layout.scale;
    result.layouts = result.packings;
    result.placements = std::move(layout.placements);
    result.pages.assign(1, {0, 0});
    double shapes = 0;
    for (std::size_t i = 0; i < result.placements.size(); ++i) {
      const FitPlacement& p = result.placements[i];
      shapes += charts_.outlines[i].area * p.scale * p.scale;
      enclose(p.box, options_, result.pages[0]);
    }
    result.utilization = share_of_pages(shapes, result);
  }

  const FitCharts charts_;
  const FitOptions& options_;
  const Context& context_;
  std::vector<ChartPair> pairs_;
  std::vector<bool> paired_;  // one per chart
  GridChoice grid_;
  std::int32_t side_ = 0;  // in cells
  double area_ = 0;        // of all charts at scale 1
};

}  // namespace

std::optional<FitResult> fit_free_page(const FitCharts& charts, const FitOptions& options,
                                       const Context& context) {
  return FreePage(charts, options, context).run();
}

}  // namespace atlas::pack
