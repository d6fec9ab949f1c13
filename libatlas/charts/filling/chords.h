// Internal: finds straight cuts across a sprawling outline.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Returns the mean of the areas of the smallest rectangle and of the convex hull. Packing pays for
// the rectangle, but the hull already shrinks with the first of two limbs that are cut off on one
// side.
inline double sprawl(double hull_area, double box_area) {
  return 0.5 * (hull_area + box_area);
}

struct Chord {
  std::uint32_t a = 0, b = 0;  // indices into the outline
  double score = 0;            // reduction of sprawl per length of the cut
};

// Returns straight cuts within a simple polygon (counter-clockwise, any number of corners), best
// first: those whose two sides together sprawl less than the whole by at least `least` (an area).
// Cuts run from concave corners (Lien and Amato 2006) to corners nearby, to other concave corners,
// or to the end of one of the shortest `edges` from there. These are pairs of indices into the
// outline that an edge of the mesh joins; a coarse mesh may have no other way across. Takes about
// O(n k + k³) for k chosen corners: at most 100 of the simplified outline (Douglas and Peucker
// 1973), some 100 between them, and ends of edges. Returns any of the cuts when cancelled.
std::vector<Chord> find_chords(std::span<const Vec2d> outline,
                               std::span<const std::array<std::uint32_t, 2>> edges, double least,
                               const Context& context);

}  // namespace atlas
