// Internal: triangles that a flat chart got from its neighbours are laid beside those it had.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Stands for the uv of a corner that is not known.
inline Vec2d unplaced() {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  return {nothing, nothing};
}

// Fills `uvs`, 1 a vertex, from those of the corners, 3 a triangle: all three of a triangle are
// known, or unplaced(). Triangles that were not there keep their shape, at the scale of the edge
// that they are laid on; in a notch they take the shape that it leaves them, turned over perhaps.
// False, and `uvs` of no use, if one hangs on no edge of the rest.
bool place_newcomers(const LocalMesh& mesh, std::span<const Vec2d> corner_uvs,
                     std::vector<Vec2d>& uvs);

}  // namespace atlas
