// Internal: the boundary part of the injectivity check, for callers that already have half-edges.
#pragma once

#include <span>

#include "libatlas/param/injectivity.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas::param {

// Sets loops, crossings, close and nested of `out`. out.flipped must be filled.
void check_border(const BorderView& view, std::span<const Vec2d> uvs,
                  const InjectivityOptions& options, Injectivity& out);

}  // namespace atlas::param
