#include "libatlas/pack/nest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/pack/engines.h"

namespace atlas::pack {
namespace {

double center_height(const Mask& mask) {
  double sum = 0;
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r)) sum += (r + 0.5) * (run.end - run.begin);
  return mask.cells > 0 ? sum / static_cast<double>(mask.cells) : 0;
}

// Where the lower left corner of the box goes when chart and mask turn by 90 degrees: chart point p
// at origin + q of a box of height h (texels) comes to (h - origin.y - q.y, origin.x + q.x).
Vec2d turned_origin(Vec2d origin, double box_height) {
  return {box_height - origin.y, origin.x};
}

// Whether the mask of a box of this size, in texels, stays within the page in some quarter turn.
bool may_fit(Vec2d box, const PieceOptions& options) {
  if (options.page == Extent{}) return true;
  const auto cells = [&](double side) {
    return std::ceil((side + 2.0 * options.padding) / options.cell * (1 - 1e-12));
  };
  const double w = cells(box.x), h = cells(box.y);
  const Extent page = options.page;
  return (w <= page.width && h <= page.height) ||
         (options.directions >= 4 && h <= page.width && w <= page.height);
}

Piece make_piece(const ChartOutline& shape, double factor, const PieceOptions& options) {
  Piece piece;
  piece.too_large = !shape.empty();
  const std::uint32_t n = options.directions;
  const std::uint32_t bases = std::max(1u, n / 4);
  std::vector<Mask> masks(n);
  piece.origins.resize(n);
  for (std::uint32_t b = 0; b < bases; ++b) {
    RasterOptions raster;
    raster.factor = factor;
    raster.angle = 2 * std::numbers::pi * b / n;
    raster.padding = options.padding;
    raster.cell = options.cell;
    const Vec2d box = options.page == Extent{} ? Vec2d{} : box_of(shape, raster.angle);
    if (!may_fit({factor * box.x, factor * box.y}, options)) continue;
    piece.too_large = false;
    masks[b] = rasterize(shape, raster, piece.origins[b]);
    for (std::uint32_t k = b + bases, quarter = 1; k < n; k += bases, ++quarter) {
      const std::uint32_t from = k - bases;
      // Two directions are half a turn apart, four a quarter.
      masks[k] = quarter_turn(masks[from]);
      piece.origins[k] =
          turned_origin(piece.origins[from], double(masks[from].height) * options.cell);
      if (n == 2) {
        const double height = double(masks[k].height) * options.cell;
        masks[k] = quarter_turn(masks[k]);
        piece.origins[k] = turned_origin(piece.origins[k], height);
      }
    }
  }
  piece.masks = std::move(masks);
  for (const Mask& m : piece.masks) {
    piece.tests.push_back(test_order(m));
    piece.centers.push_back(center_height(m));
    piece.lifts.push_back(0.5 * m.height + 0.5 * piece.centers.back());
  }
  piece.by_fraction.resize(n);
  std::iota(piece.by_fraction.begin(), piece.by_fraction.end(), 0u);
  const auto fraction = [&](std::uint32_t k) {
    return piece.lifts[k] - std::floor(piece.lifts[k]);
  };
  std::stable_sort(piece.by_fraction.begin(), piece.by_fraction.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return fraction(a) < fraction(b); });
  return piece;
}

}  // namespace

std::vector<Piece> make_pieces(std::span<const ChartOutline> shapes, const PieceOptions& options,
                               const Context& context) {
  std::vector<Piece> pieces(shapes.size());
  parallel_for(context, shapes.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      pieces[i] = make_piece(
          shapes[i], options.factors.empty() ? options.factor : options.factors[i], options);
  });
  return pieces;
}

std::int32_t longest_run(std::span<const Piece> pieces) {
  std::int32_t longest = 1;
  for (const Piece& p : pieces)
    for (const Mask& m : p.masks)
      for (const Run& run : m.runs) longest = std::max(longest, run.end - run.begin);
  return longest;
}

NestPlan plan_by_size(std::span<const Piece> pieces) {
  NestPlan plan;
  plan.order.resize(pieces.size());
  std::iota(plan.order.begin(), plan.order.end(), 0u);
  std::stable_sort(plan.order.begin(), plan.order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return pieces[a].cells() > pieces[b].cells();
  });
  plan.direction.assign(pieces.size(), kFree);
  return plan;
}

namespace {

// Where pieces of about one size were last put. Many pieces come largest first, and what is below
// the last place of their size has been searched in vain already, or nearly: the next one is looked
// for from there on, so that a page of n pieces is not scanned n times from the bottom. Sizes are
// classes of a quarter of an octave; each class begins at the bottom and fills holes of its own.
class LastPlaces {
 public:
  explicit LastPlaces(std::size_t pieces) : on_(pieces >= kMany) {}

  std::int32_t lowest(const Mask& mask) {
    return on_ ? row_[static_cast<std::size_t>(class_of(mask))] : 0;
  }
  // Nothing below `y` is free for this size; beyond the page when there was no place at all.
  void searched(const Mask& mask, std::int32_t y) {
    if (!on_) return;
    std::int32_t& row = row_[static_cast<std::size_t>(class_of(mask))];
    row = std::max(row, y);
  }

 private:
  static constexpr std::size_t kMany = 500;
  static constexpr int kSteps = 64;  // a quarter of an octave each, up to 2^16 cells

  static int step(std::int32_t cells) {
    return std::min(kSteps - 1, static_cast<int>(4 * std::log2(double(std::max(1, cells)))));
  }
  static int class_of(const Mask& mask) { return kSteps * step(mask.width) + step(mask.height); }

  bool on_;
  std::vector<std::int32_t> row_ = std::vector<std::int32_t>(on_ ? kSteps * kSteps : 0);
};

// The best direction and place of a piece on the page: heights are visited from the lowest up, at
// each of them the directions whose feet may stand there.
class PlaceSearch {
 public:
  PlaceSearch(const Piece& piece, std::int32_t only, BitPage& page, LastPlaces& last)
      : piece_(piece), page_(page), last_(last) {
    for (std::uint32_t k : piece.by_fraction) {
      const Mask& mask = piece.masks[k];
      if (only != kFree && k != static_cast<std::uint32_t>(only)) continue;
      if (mask.cells == 0 || mask.width > page.width()) continue;
      const auto lift = static_cast<std::int32_t>(std::floor(piece.lifts[k]));
      const std::int32_t foot = last.lowest(mask);
      if (foot > page.height() - mask.height) continue;
      feet_[count_++] = {k, lift, foot, page.height() - mask.height, 0, 0};
    }
  }

  bool run(NestPlace& place) {
    std::int32_t height = std::numeric_limits<std::int32_t>::max(), top = 0;
    for (Foot& f : std::span(feet_).first(count_)) {
      height = std::min(height, f.row + f.lift);
      top = std::max(top, f.last + f.lift);
    }
    for (bool found = false; height <= top && !found; ++height) found = visit(height, place);
    for (const Foot& f : std::span(feet_).first(count_))
      last_.searched(piece_.masks[f.direction], place.placed ? f.row : kNowhere);
    return place.placed;
  }

 private:
  static constexpr std::int32_t kNowhere = std::numeric_limits<std::int32_t>::max();
  static constexpr std::size_t kMostDirections = 64;

  struct Foot {
    std::uint32_t direction;
    std::int32_t lift;       // whole cells
    std::int32_t row, last;  // the next row to stand on, and the last one
    std::uint64_t likely;    // bit k: row + k; as many as are known
    std::int32_t known;
  };

  bool visit(std::int32_t height, NestPlace& place) {
    for (Foot& f : std::span(feet_).first(count_)) {
      if (f.row != height - f.lift || f.row > f.last) continue;
      const Mask& mask = piece_.masks[f.direction];
      const auto& tests = piece_.tests[f.direction];
      if (f.known == 0) {
        f.likely = page_.likely_feet(tests, f.row);
        f.known = 64;
      }
      BitPage::Place at;
      if ((f.likely & 1) != 0 &&
          page_.find_in_row(mask, tests, {0, page_.width() - mask.width}, f.row, at)) {
        place = {true, f.direction, at};
        return true;
      }
      f.likely >>= 1;
      --f.known;
      ++f.row;
    }
    return false;
  }

  const Piece& piece_;
  BitPage& page_;
  LastPlaces& last_;
  std::array<Foot, kMostDirections> feet_;
  std::size_t count_ = 0;
};

}  // namespace

void place_pieces(std::span<const Piece> pieces, const NestPlan& plan, BitPage& page, Nest& nest) {
  nest.places.resize(pieces.size());
  LastPlaces last(plan.order.size());
  for (std::uint32_t id : plan.order) {
    const Piece& piece = pieces[id];
    if (piece.too_large) nest.left_over.push_back(id);
    if (piece.cells() == 0) continue;
    NestPlace& place = nest.places[id];
    const std::int32_t only = plan.direction[id];
    if (!PlaceSearch(piece, only, page, last).run(place) &&
        (only == kFree || !PlaceSearch(piece, kFree, page, last).run(place))) {
      nest.left_over.push_back(id);
      continue;
    }
    page.put(piece.masks[place.direction], place.at);
    if (page.used_height() > plan.most_height) {
      nest.left_over.push_back(id);
      break;
    }
    nest.potential +=
        static_cast<double>(piece.cells()) * (place.at.y + piece.centers[place.direction]);
  }
  nest.used_height = page.used_height();
}

namespace {

// Disturbs a plan: swaps two pieces, moves one, or changes one's direction. Large pieces, which are
// early in the order, decide the layout and are chosen more often.
class PlanMoves {
 public:
  PlanMoves(std::span<const Piece> pieces, std::uint64_t seed) : pieces_(pieces), random_(seed) {}

  void disturb(NestPlan& plan, const Nest& nest) {
    const auto n = static_cast<std::uint32_t>(plan.order.size());
    const std::uint32_t kind = random_.below(n > 1 ? 4 : 1);
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
  // Position of the piece that ends highest: it comes earlier next time ("squeaky wheel", Joslin
  // and Clements 1999).
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

// Height in cells, with the potential as a fraction below one.
double energy(const Nest& nest, double total_cells) {
  if (!nest.left_over.empty()) return 1e6 * static_cast<double>(nest.left_over.size());
  const double mean = nest.potential / std::max(1.0, total_cells);
  return nest.used_height + mean / std::max(1.0, double(nest.used_height));
}

// How high a strip may become: pieces that do not nest, as slanted needles, could pile up for ever.
// Beyond 256 MiB of rows, and four times what the pieces fill, they are left over.
std::int32_t most_rows(std::span<const Piece> pieces, double total_cells, std::int32_t width) {
  constexpr double kBytes = 1 << 28, kLevels = 12;
  std::int32_t tallest = 1;
  for (const Piece& p : pieces)
    for (const Mask& m : p.masks) tallest = std::max(tallest, m.height);
  const double needed = tallest + 4 * total_cells / std::max(1, width);
  const double affordable = kBytes / (kLevels * 8 * (width / 64 + 2.0));
  return static_cast<std::int32_t>(std::min(std::max(needed, affordable), double(1 << 24)));
}

}  // namespace

NestPlan improve_plan(std::span<const Piece> pieces, const NestPlan& start,
                      const NestSearchOptions& options, const Context& context, Nest& best,
                      std::uint64_t& layouts) {
  const std::int32_t longest = longest_run(pieces);
  double total = 0;
  for (const Piece& p : pieces) total += static_cast<double>(p.cells());
  std::uint64_t spent = 0, tried = 0;
  BitPage page(options.width, most_rows(pieces, total, options.width), longest);
  const auto evaluate = [&](const NestPlan& plan, Nest& nest) {
    const std::uint64_t before = page.work();
    page.clear();
    nest = {};
    place_pieces(pieces, plan, page, nest);
    spent += page.work() - before + 20 * pieces.size();
    ++layouts;
    ++tried;
    return energy(nest, total);
  };
  NestPlan plan = start, current = start, best_plan = start;
  double current_energy = evaluate(start, best), best_energy = current_energy;
  PlanMoves moves(pieces, options.seed);
  Nest nest, current_nest = best;
  const double begun = wall_seconds();
  while (spent < options.work && tried < options.layouts && !pieces.empty()) {
    if (context.cancelled() || wall_seconds() - begun > options.seconds) break;
    if (best.left_over.empty() && best.used_height <= options.enough) break;
    plan = current;
    moves.disturb(plan, current_nest);
    const double left =
        1 - std::max(static_cast<double>(spent) / static_cast<double>(options.work),
                     static_cast<double>(tried) / static_cast<double>(options.layouts));
    const double temperature = std::max(1e-9, 0.004 * best_energy * left * left);
    // Metropolis' rule, the chance drawn first: a layout is given up as soon as it is too high.
    plan.most_height = current_energy - temperature * std::log(std::max(1e-300, moves.unit()));
    const double e = evaluate(plan, nest);
    if (e <= plan.most_height) {
      current = plan;
      current_energy = e;
      current_nest = nest;
    }
    if (e < best_energy) {
      best_energy = e;
      best_plan = plan;
      best = nest;
    }
  }
  best_plan.most_height = std::numeric_limits<double>::infinity();
  return best_plan;
}

}  // namespace atlas::pack
