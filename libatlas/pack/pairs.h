// Internal: joins charts that leave much of their boxes empty, such as triangles, in pairs that
// leave less.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/chart_outline.h"
#include "libatlas/pack/nest.h"

namespace atlas::pack {

// Two charts that lie along each other with an edge of their convex hulls.
struct ChartPair {
  std::uint32_t first = 0, second = 0;
  double turn = 0;  // by which the second is turned about its origin, in radians
  // The ends of both edges that meet but for the gutter, each in the coordinates of its chart.
  Vec2d end_of_first = {}, end_of_second = {};
  Vec2d normal = {};  // unit normal of the first one's edge, away from it
};

// Finds pairs whose smallest boxes are fuller than those of the charts alone. Only charts that are
// nearly convex, with few corners, are paired. Charts of similar size and shape come together. A
// chart is in one pair at most.
// May be incomplete if the context is cancelled.
std::vector<ChartPair> find_pairs(std::span<const ChartOutline> outlines, const Context& context);

// Where a chart lies in the box of its pair's mask, and the origin of its own mask, in texels.
struct PairPart {
  Rect cells = {};
  Vec2d origin = {};
};

// A pair as one piece, and the places of both charts in each direction.
struct PairPiece {
  Piece piece;
  std::vector<std::array<PairPart, 2>> parts;
};

// All charts, and the factors by which they are scaled.
struct ScaledCharts {
  std::span<const ChartOutline> outlines = {};
  std::span<const double> factors = {};
};

// Rasterises a pair. In each direction the masks of its charts lie as close along the edge as they
// can without an overlap. `options` are those of make_pieces(), but for the factors.
PairPiece make_pair_piece(const ScaledCharts& charts, const ChartPair& pair,
                          const PieceOptions& options);

}  // namespace atlas::pack
