// Internal: places the triangles that a flat chart got from its neighbours beside those it had.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// The uv of a corner that is not known yet.
inline Vec2d unplaced() {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  return {nothing, nothing};
}

// Fills `uvs`, one per vertex, from those of the corners, three per triangle, which are either all
// known or all unplaced(). A new triangle keeps its shape, at the scale of the edge that it is
// placed on; in a notch, whose corners are all placed, it takes the notch's shape and may be
// flipped. Returns false if a new triangle shares no edge with the rest; `uvs` must then not be
// used.
bool place_newcomers(const LocalMesh& mesh, std::span<const Vec2d> corner_uvs,
                     std::vector<Vec2d>& uvs);

}  // namespace atlas
