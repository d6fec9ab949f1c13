// Internal: given charts that are folded over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// A part is a connected set of triangles that turn the same way in uv.
struct UvFolds {
  std::vector<std::uint32_t> part;   // 1 a triangle; kNoIndex: not divided; or empty: none is
  std::vector<std::uint32_t> owner;  // 1 a part: its component; those of one stand together
};

struct GivenMesh {
  const Topology& topology;
  const MeshView& mesh;  // texcoord_indices as from usable_texcoords
};

// Divides one component (its triangles) where its given uvs fold over, as mirrored halves do that
// share the texcoords of their common edge, and adds its parts to `folds`. It stays whole if it has
// no fold, a triangle without uv area, or a part of less than 5 % of its area, which rather is a
// few flipped triangles. Senses of rotation are exact.
void divide_at_folds(const GivenMesh& given, std::uint32_t component,
                     std::span<const std::uint32_t> triangles, UvFolds& folds);

}  // namespace atlas
