// Internal: spreads clusters of uvs that are too close to each other for single precision.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/vec.h"

namespace atlas {

// Scans that were cut out of a grid have specks: clusters of tiny triangles around a grid point, of
// a few millionths of a millionth of the mesh. Their uvs are equal, or are turned over by rounding.
// Such clusters of thin triangles (thin_uvs.h) are drawn anew within a circle whose radius is some
// ten to five hundred last places of a float. Each uv is placed at the mean of its neighbours
// (Tutte 1963, "How to draw a graph"), and uvs around the cluster count as points of the circle in
// their direction from the middle. A cluster stays as it is if that would not leave fewer thin
// triangles. `corners` are three per triangle, counter-clockwise except for what rounding has
// turned over. `corners_at` are the corners at each uv.
void spread_specks(std::span<const std::uint32_t> corners, const Buckets& corners_at,
                   std::vector<Vec2f>& uvs);

}  // namespace atlas
