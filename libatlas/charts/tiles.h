// Cuts charts that are too long for a page at the desired density into pieces that fit.
#pragma once

#include <cstddef>
#include <span>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas {

struct TileLimits {
  // Of charts' boxes, scene units; one per chart, > 0 (any for points).
  std::span<const double> sides = {};
  double max_stretch = 1.25;  // of pieces, > 1: ChartOptions::max_stretch
};

// Cuts every chart whose box is longer than its limit across its long side, repeatedly, until the
// pieces fit, or no cut divides them, or more than eight triangles are left that are about as long
// as the piece (a disc as a fan gives quarters). A cut is the shortest path along edges near the
// even share; on regular meshes it is straight. Pieces keep their parent's uvs, shifted, and turned
// for packing (those of given charts, Chart::kept, by 90 degrees at most), and so stay injective.
// What stretched a small part of a chart by more than max_stretch may be a large part of a piece:
// such a piece is relaxed or cut further, unless the parent itself exceeds the bound or was given
// (Chart::kept). Each piece is connected by edges. Cone and axis stay the parent's; distortion is
// measured again, and so is the total. Charts within their limit keep their order; pieces take the
// place of their parent. Returns how many charts were cut. The result is the same for every thread
// count. Errors: bad_input (not one limit per chart, or one that is not above 0; charts of another
// mesh, or whose ranges and indices contradict each other; materials or densities that make_charts
// refuses); bad_option (max_stretch); cancelled. The charts are then unchanged.
Result<std::size_t> cut_to_limits(const MeshView& mesh, const TileLimits& limits, ChartSet& charts,
                                  const Context& context);

}  // namespace atlas
