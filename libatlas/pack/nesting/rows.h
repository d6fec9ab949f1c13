// Internal: lays copies of one chart in rows whose neighbours interlock.
#pragma once

#include <span>
#include <vector>

#include "libatlas/pack/nesting/joined_piece.h"
#include "libatlas/pack/outlines/alike.h"

namespace atlas::pack {

// How copies lie in rows along the x axis.
struct RowPlan {
  AlikeCharts alike;
  double angle = 0;        // by which the first chart is turned, in radians
  bool alternate = false;  // whether every other chart is turned by 180 degrees more,
  double rise = 0;         // and lies this much higher, in units of the outlines
  double density = 0;      // the share of the plane that such rows cover, without gutters
};

// Returns plans for the groups of at least 24 copies. For each, the densest rows are chosen among
// 24 directions and those of the longest edges of the convex hull: the charts then form a lattice
// or a double lattice (Kuperberg and Kuperberg 1990). May be incomplete if the context is
// cancelled.
std::vector<RowPlan> find_rows(std::span<const ChartOutline> outlines, const Context& context);

// Lays the charts in rows that are no longer than `length` cells. Every chart lies as close to
// those before it as their masks allow. Pieces have a mask in direction 0 only. `options` are those
// of make_pieces(), but for the factors.
std::vector<JoinedPiece> make_row_pieces(const ScaledCharts& charts, const RowPlan& plan,
                                         const PieceOptions& options, std::int32_t length);

}  // namespace atlas::pack
