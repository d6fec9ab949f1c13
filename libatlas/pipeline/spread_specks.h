// Internal: uvs that single precision leaves no room between.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Scans cut out of a grid have specks of a few millionths of a millionth of the mesh around a grid
// point; their uvs are equal, or turned over by rounding. Such clusters of thin triangles
// (thin_uvs.h) are drawn anew within a circle of some ten to five hundred last places of a float,
// uniformly (Tutte 1963, "How to draw a graph"), with their surroundings where they are seen from
// the middle. What would not leave fewer thin triangles stays as it is. `corners`: 3 a triangle,
// counter-clockwise but for what rounding turned; `corners_at`: those of each uv.
void spread_specks(std::span<const std::uint32_t> corners, const Buckets& corners_at,
                   std::vector<Vec2f>& uvs);

}  // namespace atlas
