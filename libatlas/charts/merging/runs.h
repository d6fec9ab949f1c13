// Internal: runs, the connected parts of the common border of two charts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// Of several separate runs of the common border `glue`, keeps the one that costs most as a
// seam (border_weight); the rest becomes a seam of the chart with itself. Returns false if there is
// only one run. Runs also end at the points `forks`, where a seam ends: otherwise the chart would
// close around such a point.
bool keep_longest_run(const CoarseMesh& mesh, std::span<const Vec3d> forks,
                      std::vector<std::uint32_t>& glue);

}  // namespace atlas
