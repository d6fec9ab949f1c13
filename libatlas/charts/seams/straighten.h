// Internal: straightens the borders between charts, by minimum cuts in bands along them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/seams/refine.h"
#include "libatlas/core/context.h"

namespace atlas {

struct StraightenOptions {
  BorderRules rules = {};
  // One per chart: how many triangles to each side its borders may move; 0: they stay.
  std::span<const std::uint8_t> rings = {};
  // All triangles of the charts with rings; empty: those of all charts.
  std::span<const std::uint32_t> triangles{};
};

// Replaces the border between each two charts by the cheapest one (border_weight) within the
// narrower of their two bands, found as a minimum cut of the dual graph (the idea:
// Katz and Tal 2003). This shortens borders that moves of single triangles cannot, such as the
// steps of a staircase. A border stays as it is where a chart would come apart, close to a ring or
// leave its cone. Borders that share no chart are straightened in parallel. Returns the half-edges
// across which triangles changed charts, in order, for carry_frames().
std::vector<std::uint32_t> straighten_borders(const Topology& topology,
                                              const StraightenOptions& options,
                                              Partition& partition, const Context& context);

}  // namespace atlas
