// Whether a flattening is one-to-one: decided by exact predicates, not by tolerance.
//
// Theorem used. Let every triangle be positively oriented in uv. The number of triangles that cover
// a point off all edges is then the degree of the map there, and the degree is the winding number
// of the border's image about the point. If the border's loops are simple, touch at most in points
// where their corners are apart, and exactly one turns counter-clockwise, that number is 0 or 1
// everywhere: no two triangles overlap. For a disc (one loop) a simple border suffices. Interior
// vertices that the triangles go round twice are thereby excluded as well: a neighbourhood of one
// would be covered twice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

struct InjectivityOptions {
  // Room for rounding: uvs written with an absolute error of at most e in each coordinate keep a
  // map injective that passes with clearance = 3 e (uv units). It asks that every triangle's
  // smallest altitude, and the gap between any two border edges without a common vertex, are not
  // below it. 0: none.
  double clearance = 0;
  std::size_t max_crossings = 64;  // stop listing there; the verdict does not change
};

struct BorderCrossing {
  std::array<std::uint32_t, 2> a, b;  // border edges as vertex pairs, in their triangle's direction
  std::uint32_t triangle_a = 0, triangle_b = 0;  // the triangles they belong to
};

struct Injectivity {
  bool injective = false;
  std::vector<std::uint32_t> flipped;  // triangles whose orientation in uv is not positive (exact)
  std::vector<BorderCrossing>
      crossings;            // pairs of border edges that cross, stretch along each other, or begin
                            // at two vertices in one point, around which triangles overlap
  std::uint32_t loops = 0;  // border loops
  bool nested =
      false;  // no crossing, yet not exactly one loop counter-clockwise: folded over itself
  // Only with clearance > 0; they do not make `injective` false.
  std::vector<std::uint32_t> thin;    // triangles with an altitude below clearance
  std::vector<BorderCrossing> close;  // border edges nearer than clearance
};

// uvs.size() == positions.size(). The mesh's border must be a manifold: each border vertex has one
// outgoing border edge (else `nested` is set when the exact walk meets it). O(n log n) for borders
// that do not cross themselves everywhere. Two borders that touch in coincident end points only do
// not cross.
Injectivity check_injectivity(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                              const InjectivityOptions& options = {});

}  // namespace atlas
