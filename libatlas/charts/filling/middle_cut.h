// Internal: divides frames, lattices and slit rings, which no chord divides with gain.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/core/context.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas {

struct MiddleCut {
  std::vector<std::vector<std::uint32_t>> parts;  // at least two, each ascending and connected
  // The whole's sprawl minus the sum of the parts' ones; may be negative.
  double fall = 0;
  double length = 0;
};

struct MiddleCutLimits {
  double crumb = 0;                              // area; smaller parts stay with a neighbour
  double least_fall = 0;                         // area
  std::span<const std::uint32_t> polygons = {};  // as for LineCutter
  const Context* context = nullptr;              // polled between lines; may be null
};

// Divides `triangles` (indices into chart.triangles, connected) near lines in several directions
// and places (LineCutter). Of the cuts that reduce the sprawl by at least least_fall, returns the
// one with the largest reduction for its length; if there is none, the shortest one through the
// middle. Returns no parts where triangles are too large for any cut, and any of the cuts when
// cancelled.
MiddleCut cut_middle(const FlatChart& chart, const param::HalfEdges& half_edges,
                     std::span<const std::uint32_t> triangles, const MiddleCutLimits& limits);

}  // namespace atlas
