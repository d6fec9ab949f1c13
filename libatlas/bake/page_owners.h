// Internal: determines which texels of a page each of its charts writes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/bake/bake.h"

namespace atlas {

// Neighbouring texels in one row of the page.
struct TexelRun {
  std::int32_t x = 0, y = 0, length = 0;
};

struct PageOwners {
  std::vector<std::vector<TexelRun>> runs;  // one list per placement; no texel is in two of them
  std::vector<std::uint8_t> taken;          // one per texel of the page: 0 if no chart owns it
  // How many texels several charts claim; the position of the lowest such texel; and two of the
  // charts that claim it.
  std::uint64_t contested = 0;
  std::int32_t x = 0, y = 0;
  std::uint32_t charts[2] = {0, 0};
};

// Determines which chart owns each texel. A chart packed by its box claims the box with its pads. A
// chart packed by its outline claims the cells that come within the pad of one of its triangles
// (ownership.h). On a page that was packed for as many mip levels as are baked, no texel is
// contested. A texel that several charts claim goes to the chart whose triangles, or whose inner
// box, are nearest to it in the maximum norm of texels, and among equally near ones to the lower
// chart. The result is therefore the same for every thread count and every order of the placements.
// It is incomplete once cancelled.
PageOwners find_owners(const ChartSet& charts, std::span<const ChartPlacement> placements,
                       const BakeOptions& options, const Context& context);

}  // namespace atlas
