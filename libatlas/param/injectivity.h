// Decides whether a flattening is injective: by exact predicates, not by tolerance.
//
// Theorem used. Let every triangle be positively oriented in uv. The number of triangles that cover
// a point off all edges is then the degree of the map there, and the degree is the winding number
// of the border's image about the point. If the boundary loops are simple, touch at most in points
// where their corners do not overlap, and exactly one of them turns counter-clockwise, that number
// is 0 or 1 everywhere: no two triangles overlap. For a disc (one loop) a simple border suffices.
// This also excludes interior vertices that the triangles surround twice, since a neighbourhood of
// such a vertex would be covered twice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

struct InjectivityOptions {
  // Margin for rounding: uvs written with an absolute error of at most e in each coordinate keep a
  // map injective that passes with clearance = 3 e (uv units). The check then lists as thin and
  // close what is below the clearance: the smallest altitude of a triangle, or the gap between two
  // border edges of different triangles. With a common vertex, the gap is that of the shorter
  // edge's other end. 0: no such check.
  double clearance = 0;
  std::size_t max_crossings = 64;  // listing stops there; the verdict does not change
};

struct BorderCrossing {
  std::array<std::uint32_t, 2> a, b;  // border edges as vertex pairs, in their triangle's direction
  std::uint32_t triangle_a = 0, triangle_b = 0;  // the triangles that they belong to
};

struct Injectivity {
  bool injective = false;
  std::vector<std::uint32_t> flipped;  // triangles whose orientation in uv is not positive (exact)
  // Pairs of border edges that cross, that overlap along their length, or that begin at two
  // vertices in the same point around which triangles overlap.
  std::vector<BorderCrossing> crossings;
  std::uint32_t loops = 0;  // boundary loops
  // No crossing, but not exactly one loop is counter-clockwise: the map folds over itself.
  bool nested = false;
  // Only with clearance > 0. These do not make `injective` false.
  std::vector<std::uint32_t> thin;    // triangles with an altitude below the clearance
  std::vector<BorderCrossing> close;  // border edges closer to each other than the clearance
};

// Checks a map with uvs.size() == positions.size(). The mesh's border must be a manifold: each
// border vertex has one outgoing border edge (otherwise `nested` is set when the exact walk meets
// it). O(n log n), unless the border crosses itself everywhere. Two borders that touch only in
// coincident end points do not cross.
Injectivity check_injectivity(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                              const InjectivityOptions& options = {});

}  // namespace atlas
