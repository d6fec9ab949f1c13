// Internal: stretches of common border.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/coarse.h"

namespace atlas {

// Of several separate stretches of common border, the arcs `glue`, keeps the longest: the rest
// becomes a seam of the chart with itself. False if there is only one. A point of `forks`, where a
// seam ends, between two arcs parts them, or the chart would close around it.
bool keep_longest_run(const CoarseMesh& mesh, std::span<const Vec3d> forks,
                      std::vector<std::uint32_t>& glue);

}  // namespace atlas
