// Internal: which triangles of a mesh are those of an earlier one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/core/no_index.h"
#include "libatlas/unwrap/like/joined_mesh.h"

namespace atlas {

struct TriangleMatch {
  std::uint32_t earlier = kNoIndex;          // the triangle of the earlier mesh, or none
  std::array<std::uint8_t, 3> corners = {};  // one per corner: the earlier triangle's
  // A corner lies farther from where it lay than the tolerance.
  bool moved = false;
};

// Returns the match of each triangle; no two have the same. Corners match the nearest earlier ones
// within `tolerance`, of the same object if both meshes have objects, so numbers and orders do not
// matter. From triangles that match in this way,
// matches go on across edges, as long as both meshes are joined alike: triangles whose corners have
// been moved farther are found so. O(n log n).
std::vector<TriangleMatch> match_triangles(const JoinedMesh& mesh, const JoinedMesh& earlier,
                                           double tolerance);

}  // namespace atlas
