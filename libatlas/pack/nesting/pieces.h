// Internal: charts as masks of cells, in all directions in which they may be placed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/pack/nesting/bit_page.h"

namespace atlas::pack {

// One chart in all directions that are tried. Direction k is turned by k · 360 / directions
// degrees.
struct Piece {
  std::vector<Mask> masks;
  std::vector<MaskTests> tests;  // one per mask, or none; see PieceOptions::keep_tests
  std::vector<Vec2d> origins;    // see RasterOptions; empty for pairs of charts
  std::vector<double> centers;   // height of each mask's centre of mass
  // A direction's lift is half the mask's height plus half the height of its centre. The height of
  // a place, by which places are compared, is the row of its foot plus the lift.
  std::vector<double> lifts;
  // Directions in ascending order of the fractional parts of their lifts.
  std::vector<std::uint32_t> by_fraction;
  // Too large in every direction: it has no masks, although the shape has corners.
  bool too_large = false;

  std::int64_t cells() const {
    for (const Mask& m : masks)
      if (m.cells > 0) return m.cells;
    return 0;
  }
};

struct PieceOptions {
  double factor = 1;                // texels of the page per texel of the shape
  std::span<const double> factors;  // one per shape, instead of the common factor; or empty
  std::int32_t padding = 1, cell = 1;
  std::uint32_t directions = 4;
  // The page in cells. A shape gets no mask in a direction in which it exceeds the page. 0 x 0: no
  // limit.
  Extent page;
  // The shapes that are rasterised, by index, in this order; empty: all.
  std::span<const std::uint32_t> only;
  // Whether pieces keep the tests of their masks, which take about as much memory as the masks
  // themselves. If not, place_pieces() makes them anew for each piece that it places. This takes no
  // more time in all if pieces are only placed once.
  bool keep_tests = true;
  // Whether pieces get masks and origins only, for callers that place none of them.
  bool masks_only = false;
};

// Sets what follows from the masks: centers, lifts and by_fraction, and the tests if they are kept.
void complete(Piece& piece, bool keep_tests);

// Rasterises the shapes in all directions. Quarter turns are made by turning masks, which is exact.
// Without the page as a limit, the memory that masks take grows with the length of the shapes.
std::vector<Piece> make_pieces(std::span<const ChartOutline> shapes, const PieceOptions& options,
                               const Context& context);

// Returns the length of the longest run of cells in any mask.
std::int32_t longest_run(std::span<const Piece> pieces);

}  // namespace atlas::pack
