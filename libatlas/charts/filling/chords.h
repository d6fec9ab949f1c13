// Internal: where a sprawling outline can be cut across.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Half the areas of the smallest rectangle and of the convex hull: the first is what packing pays
// for, the second falls already with the first of two limbs on one side.
inline double sprawl(double hull_area, double box_area) {
  return 0.5 * (hull_area + box_area);
}

struct Chord {
  std::uint32_t a = 0, b = 0;  // places in the outline
  double score = 0;            // fall of the sprawl for its length; larger is better
};

// Straight cuts within a simple polygon (counter-clockwise, any number of corners), from its
// concave corners to corners nearby or concave or at the end of one of the shortest `edges` from
// there (pairs of places in the outline that an edge of the mesh joins: a coarse mesh may have no
// other way across), best first: those whose two sides sprawl less than the whole by at least
// `least` (an area). About O(n k + k³) with k, the corners
// after simplification (Douglas and Peucker 1973), at most some 150. Cutting at concave corners:
// Lien and Amato 2006.
std::vector<Chord> find_chords(std::span<const Vec2d> outline,
                               std::span<const std::array<std::uint32_t, 2>> edges, double least);

}  // namespace atlas
