// Internal: where a frame, a lattice or a slit ring can be divided, which no chord divides with
// gain.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/param/halfedges.h"

namespace atlas {

struct MiddleCut {
  std::vector<std::vector<std::uint32_t>> parts;  // two at least, each ascending and in one piece
  double fall = 0;  // of what the parts sprawl together, below the whole; may be negative
  double length = 0;
};

struct MiddleCutLimits {
  double crumb = 0;       // area; smaller parts stay with a neighbour
  double least_fall = 0;  // area
};

// Divides `triangles` of the chart (places in chart.triangles, in one piece) near lines in several
// directions and places (LineCutter). Of those cuts that let the sprawl fall by least_fall at
// least, the one with the most of it for its length; else the shortest one through the middle; none
// where triangles are too large for any.
MiddleCut cut_middle(const FlatChart& chart, const param::HalfEdges& half_edges,
                     std::span<const std::uint32_t> triangles, const MiddleCutLimits& limits);

}  // namespace atlas
