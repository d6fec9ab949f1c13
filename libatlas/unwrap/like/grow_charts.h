// Internal: which chart goes on over triangles without uvs, and which corners are one uv there.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/disjoint_sets.h"
#include "libatlas/unwrap/like/take_uvs.h"

namespace atlas {

struct GrownCharts {
  std::vector<std::uint32_t> uv;  // one per corner: the lowest corner with the same uv
  // One per triangle of a chart: 1 if its corners run counter-clockwise on the page, else -1.
  std::vector<std::int8_t> sense;
};

// Gives triangles without uvs the chart that they continue (TakenState::beside), where there is
// one, but no texels; marks the seams between charts.
GrownCharts grow_charts(const JoinedMesh& mesh, TakenUvs& taken);

}  // namespace atlas
