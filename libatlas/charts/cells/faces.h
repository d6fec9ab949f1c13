// Internal: the flat faces of a mesh, as CAD parts have them.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/charts/cells/cell_plan.h"
#include "libatlas/charts/cells/regions.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Finds the faces of the pieces that are not left out: connected triangles in one plane, with at
// least about a quarter of a cell's area. It finds none where faces would divide a piece into more
// than three times as many regions as it has planned cells. Linear in the number of triangles.
Regions find_faces(const Topology& topology, const CellPlan& plan,
                   std::span<const std::uint8_t> left_out = {});

}  // namespace atlas
