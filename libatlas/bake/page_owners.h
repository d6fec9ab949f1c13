// Internal: which texels of a page each of its charts writes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/bake/bake.h"

namespace atlas {

// Texels of one row of the page.
struct TexelRun {
  std::int32_t x = 0, y = 0, length = 0;
};

struct PageOwners {
  std::vector<std::vector<TexelRun>> runs;  // 1 a placement; no texel is in two of them
  std::vector<std::uint8_t> taken;          // 1 a texel of the page: 0 where it is in none
  // Texels that several charts claim, and of the lowest one where it is and two of these charts.
  std::uint64_t contested = 0;
  std::int32_t x = 0, y = 0;
  std::uint32_t charts[2] = {0, 0};
};

// A chart packed by its box claims the box with its pads; one packed by its outline the cells that
// come within the pad of one of its triangles (ownership.h). Pages that were packed for as many mip
// levels as are baked leave nothing contested. A texel that several charts claim goes to the one
// whose triangles, or whose inner box, are nearest to it, in the maximum norm of texels; of equally
// near ones to the lower chart, so that the result is the same for every thread count and order of
// placements. Incomplete once cancelled.
PageOwners find_owners(const ChartSet& charts, std::span<const ChartPlacement> placements,
                       const BakeOptions& options, const Context& context);

}  // namespace atlas
