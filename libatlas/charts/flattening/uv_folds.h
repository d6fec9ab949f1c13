// Internal: finds given charts that fold over, and divides them at their folds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// A part is a connected set of triangles with the same orientation in uv.
struct UvFolds {
  std::vector<std::uint32_t> part;  // one per triangle; kNoIndex: not divided; empty: no component
                                    // is
  // One per part: its component. The parts of a component are contiguous.
  std::vector<std::uint32_t> owner;
};

struct GivenMesh {
  const Topology& topology;
  const MeshView& mesh;  // texcoord_indices as from usable_texcoords
};

// Divides one component (given by its triangles) where its given uvs fold over, as mirrored halves
// do that share the texcoords of their common edge. Adds its parts to `folds`. The component stays
// whole if it has no fold, a triangle without uv area, or a part of less than 5 % of its area,
// which is more likely a few flipped triangles. Orientations are exact.
void divide_at_folds(const GivenMesh& given, std::uint32_t component,
                     std::span<const std::uint32_t> triangles, UvFolds& folds);

}  // namespace atlas
