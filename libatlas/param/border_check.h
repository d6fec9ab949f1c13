// Internal: the border's half of the injectivity check, for callers that have the half-edges
// already.
#pragma once

#include <span>

#include "libatlas/param/halfedges.h"
#include "libatlas/param/injectivity.h"

namespace atlas::param {

// Sets loops, crossings, close and nested of `out`, given out.flipped.
void check_border(const HalfEdges& half_edges, const HalfEdges::Border& border,
                  std::span<const Vec2d> uvs, const InjectivityOptions& options, Injectivity& out);

}  // namespace atlas::param
