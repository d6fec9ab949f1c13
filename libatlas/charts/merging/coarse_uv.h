// Internal: the flat coordinates of cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// Kept while charts grow: cells of one chart lie in one plane.
struct CoarseUv {
  std::vector<Vec2d> centre;  // 1 a cell
  std::vector<Vec2d> slot;    // 1 a slot
};

// Turns a cell's corners into the plane of its mean normal, each at its distance from the centre.
void project_cell(const CoarseMesh& mesh, std::uint32_t k, CoarseUv& uv);

// The map from space to the plane that a cell's coarse flattening stands for: the rotation that
// best takes its fan to its flat coordinates, as two rows.
std::array<Vec3d, 2> cell_frame(const CoarseMesh& mesh, const CoarseUv& uv, std::uint32_t k);

}  // namespace atlas
