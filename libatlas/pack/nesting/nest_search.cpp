#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/random.h"
#include "libatlas/pack/nesting/nest.h"

namespace atlas::pack {
namespace {

// Changes a plan a little: it swaps two pieces, moves one, or changes the direction of one. Large
// pieces, which come early in the order, decide the layout and are chosen more often.
class PlanMoves {
 public:
  PlanMoves(std::span<const Piece> pieces, std::uint64_t seed) : pieces_(pieces), random_(seed) {}

  void disturb(NestPlan& plan, const Nest& nest) {
    const auto n = static_cast<std::uint32_t>(plan.order.size());
    const std::uint32_t kind = random_.below(4);
    const std::uint32_t i = kind == 3 ? highest(plan, nest) : pick(n);
    if (kind == 0) {
      std::int32_t& direction = plan.direction[plan.order[i]];
      const auto count = static_cast<std::uint32_t>(pieces_[plan.order[i]].masks.size());
      direction = random_.below(3) == 0 ? kFree : static_cast<std::int32_t>(random_.below(count));
      return;
    }
    const std::uint32_t j = kind == 3 ? random_.below(i + 1) : pick(n);
    const auto at = [&](std::uint32_t k) { return plan.order.begin() + k; };
    if (kind == 1)
      std::swap(plan.order[i], plan.order[j]);
    else if (i < j)
      std::rotate(at(i), at(i + 1), at(j + 1));
    else
      std::rotate(at(j), at(i), at(i + 1));
  }
  double unit() { return random_.unit(); }

 private:
  // Returns the position of the piece whose top is highest. It is moved to an earlier position next
  // time ("squeaky wheel", Joslin and Clements 1999).
  std::uint32_t highest(const NestPlan& plan, const Nest& nest) const {
    std::uint32_t best = 0;
    std::int32_t top = -1;
    for (std::uint32_t k = 0; k < plan.order.size(); ++k) {
      const NestPlace& p = nest.places[plan.order[k]];
      if (!p.placed) continue;
      const std::int32_t t = p.at.y + pieces_[plan.order[k]].masks[p.direction].height;
      if (t > top) {
        top = t;
        best = k;
      }
    }
    return best;
  }

  std::uint32_t pick(std::uint32_t n) {
    const double u = random_.unit();
    return std::min(n - 1, static_cast<std::uint32_t>(u * std::sqrt(u) * n));
  }
  std::span<const Piece> pieces_;
  Random random_;
};

constexpr double kMostRows = 1 << 24;  // of a strip

// Returns the height in cells plus the potential as a fraction below one. Pieces that are left over
// weigh more than any height.
double energy(const Nest& nest, double total_cells) {
  if (!nest.left_over.empty()) return 2 * kMostRows * static_cast<double>(nest.left_over.size());
  const double mean = nest.potential / std::max(1.0, total_cells);
  return nest.used_height + mean / std::max(1.0, double(nest.used_height));
}

double sum_of_cells(std::span<const Piece> pieces) {
  double sum = 0;
  for (const Piece& p : pieces) sum += static_cast<double>(p.cells());
  return sum;
}

// Returns the maximum height of a strip. Pieces that do not nest, such as slanted needles, could
// pile up without limit. They are left over beyond the larger of 256 MiB of rows and four times the
// height that the pieces fill.
std::int32_t most_rows(std::span<const Piece> pieces, double total_cells, std::int32_t width) {
  constexpr double kBytes = 1 << 28, kLevels = 12;
  std::int32_t tallest = 1;
  for (const Piece& p : pieces)
    for (const Mask& m : p.masks) tallest = std::max(tallest, m.height);
  const double needed = tallest + 4 * total_cells / std::max(1, width);
  const double affordable = kBytes / (kLevels * 8 * (width / 64 + 2.0));
  return static_cast<std::int32_t>(std::min(std::max(needed, affordable), kMostRows));
}

}  // namespace

struct NestSearch::State {
  State(std::span<const Piece> all, const NestPlan& start, const NestSearchOptions& how)
      : pieces(all),
        options(how),
        total(sum_of_cells(all)),
        page(how.width, most_rows(all, total, how.width), longest_run(all)),
        moves(all, how.seed),
        alone(start.order.size() == 1) {
    // A single piece has no order. After the start it is placed in each direction once.
    if (alone)
      options.layouts = std::min<std::uint64_t>(how.layouts, 1 + all[start.order[0]].masks.size());
    next.plan = start;
  }

  double evaluate(PlacedPlan& placed) {
    place_pieces_as(pieces, current, page, placed);
    found.work += std::accumulate(placed.work.begin(), placed.work.end(), 20 * pieces.size());
    ++found.layouts;
    return energy(placed.nest, total);
  }

  void begin() {
    current_energy = best_energy = evaluate(next);
    std::swap(current, next);
    found.nest = current.nest;
  }

  // Returns the share of its limits that the search has used up.
  double spent() const {
    return std::max(double(found.work) / double(options.work),
                    double(found.layouts) / double(options.layouts));
  }

  void step() {
    next.plan = current.plan;
    if (alone)
      next.plan.direction[current.plan.order[0]] = static_cast<std::int32_t>(found.layouts) - 1;
    else
      moves.disturb(next.plan, current.nest);
    const double left = 1 - spent();
    const double temperature = std::max(1e-9, 0.004 * best_energy * left * left);
    // This is Metropolis' rule, but the random number is drawn first, so that a layout can be given
    // up as soon as it is too high.
    const double most =
        current_energy - temperature * portable::log(std::max(1e-300, moves.unit()));
    next.plan.most_height = most;
    const double e = evaluate(next);
    if (e < best_energy) {
      best_energy = e;
      found.nest = next.nest;
    }
    if (e <= most) {
      std::swap(current, next);
      current_energy = e;
    }
  }

  std::span<const Piece> pieces;
  NestSearchOptions options;
  double total;  // cells of all pieces
  BitPage page;
  PlanMoves moves;
  bool alone;
  PlacedPlan current, next;
  NestSearchResult found;
  double current_energy = 0, best_energy = 0;
};

NestSearch::NestSearch(std::span<const Piece> pieces, const NestPlan& start,
                       const NestSearchOptions& options)
    : state_(std::make_unique<State>(pieces, start, options)) {}
NestSearch::NestSearch(NestSearch&&) noexcept = default;
NestSearch& NestSearch::operator=(NestSearch&&) noexcept = default;
NestSearch::~NestSearch() = default;

const NestSearchResult& NestSearch::run(double share, const Context& context) {
  State& s = *state_;
  if (s.found.layouts == 0) s.begin();
  while (s.spent() < share && !s.pieces.empty()) {
    if (context.cancelled() || wall_seconds() >= s.options.deadline) break;
    const Nest& best = s.found.nest;
    if (best.left_over.empty() && best.used_height <= s.options.enough) break;
    s.step();
  }
  return s.found;
}

NestSearchResult search_nest(std::span<const Piece> pieces, const NestPlan& start,
                             const NestSearchOptions& options, const Context& context) {
  return NestSearch(pieces, start, options).run(1, context);
}

}  // namespace atlas::pack
