#include "libatlas/pack/nesting/pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "libatlas/core/parallel.h"

namespace atlas::pack {
namespace {

double center_height(const Mask& mask) {
  double sum = 0;
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r)) sum += (r + 0.5) * (run.end - run.begin);
  return mask.cells > 0 ? sum / static_cast<double>(mask.cells) : 0;
}

// Returns the new lower left corner of the box if the chart and its mask turn by 90 degrees. A
// chart point p at origin + q in a box of height h (texels) moves to (h - origin.y - q.y, origin.x
// + q.x).
Vec2d turned_origin(Vec2d origin, double box_height) {
  return {box_height - origin.y, origin.x};
}

// Returns whether the mask of a box of this size, in texels, fits the page in some quarter turn.
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
    // Two directions are half a turn apart, four are a quarter turn apart.
    if (n >= 4) {
      const double height = double(masks[b].height) * options.cell;
      masks[b + bases] = quarter_turn(masks[b]);
      piece.origins[b + bases] = turned_origin(piece.origins[b], height);
    }
    const std::uint32_t half = n >= 4 ? 2 * bases : bases;
    for (std::uint32_t k = b + half; k < n; k += bases) {
      const Mask& from = masks[k - half];
      const Vec2d origin = piece.origins[k - half];
      masks[k] = half_turn(from);
      piece.origins[k] = {double(from.width) * options.cell - origin.x,
                          double(from.height) * options.cell - origin.y};
    }
  }
  piece.masks = std::move(masks);
  if (!options.masks_only) complete(piece, options.keep_tests);
  return piece;
}

}  // namespace

void complete(Piece& piece, bool keep_tests) {
  for (const Mask& m : piece.masks) {
    if (keep_tests) piece.tests.push_back(test_order(m));
    piece.centers.push_back(center_height(m));
    piece.lifts.push_back(0.5 * m.height + 0.5 * piece.centers.back());
  }
  piece.by_fraction.resize(piece.masks.size());
  std::iota(piece.by_fraction.begin(), piece.by_fraction.end(), 0u);
  const auto fraction = [&](std::uint32_t k) {
    return piece.lifts[k] - std::floor(piece.lifts[k]);
  };
  std::stable_sort(piece.by_fraction.begin(), piece.by_fraction.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return fraction(a) < fraction(b); });
}

std::vector<Piece> make_pieces(std::span<const ChartOutline> shapes, const PieceOptions& options,
                               const Context& context) {
  const bool all = options.only.empty();
  std::vector<Piece> pieces(all ? shapes.size() : options.only.size());
  parallel_for(context, pieces.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t i = all ? k : options.only[k];
      pieces[k] = make_piece(
          shapes[i], options.factors.empty() ? options.factor : options.factors[i], options);
    }
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

}  // namespace atlas::pack
