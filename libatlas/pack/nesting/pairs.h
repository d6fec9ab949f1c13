// Internal: joins charts that leave much of their boxes empty, such as triangles, in pairs that
// leave less.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/nesting/joined_piece.h"
#include "libatlas/pack/outlines/chart_outline.h"

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

// Rasterises a pair. In each direction the masks of its charts lie as close along the edge as they
// can without an overlap. `options` are those of make_pieces(), but for the factors.
JoinedPiece make_pair_piece(const ScaledCharts& charts, const ChartPair& pair,
                            const PieceOptions& options);

}  // namespace atlas::pack
