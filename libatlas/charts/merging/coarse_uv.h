// Internal: the flat coordinates of the coarse mesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// Coordinates persist while charts grow: the cells of one chart lie in one common plane.
struct CoarseUv {
  std::vector<Vec2d> centre;  // one per cell
  std::vector<Vec2d> slot;    // one per slot
};

// Projects a cell's corners to the plane of its mean normal, keeping their distances from the
// centre.
void project_cell(const CoarseMesh& mesh, std::uint32_t k, CoarseUv& uv);

// Returns the map from space to the plane that a cell's coarse flattening implies, as two rows: the
// rotation that best takes its fan to its flat coordinates.
std::array<Vec3d, 2> cell_frame(const CoarseMesh& mesh, const CoarseUv& uv, std::uint32_t k);

}  // namespace atlas
