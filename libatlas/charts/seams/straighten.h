// Internal: straightens the borders between charts, by minimum cuts in bands along them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/seams/refine.h"
#include "libatlas/core/context.h"

namespace atlas {

// How far the borders of a chart may move.
struct SeamBand {
  std::uint8_t rings = 0;  // triangles to each side; 0: the borders stay
  // A triangle that changes sides must shorten the border by this share of its own size. With a
  // smaller share, borders are shorter and charts stretch more.
  float stiffness = 0.3F;
};

struct StraightenOptions {
  BorderRules rules = {};
  std::span<const SeamBand> bands = {};  // one per chart
  // All triangles of the charts with rings; empty: those of all charts.
  std::span<const std::uint32_t> triangles{};
};

// Replaces the border between each two charts by the shortest one (creases count a quarter) within
// the narrower and stiffer of their two bands, found as a minimum cut of the dual graph (the idea:
// Katz and Tal 2003). This shortens borders that moves of single triangles cannot, such as the
// steps of a staircase. A border stays as it is where a chart would come apart, close to a ring or
// leave its cone. Borders that share no chart are straightened in parallel. Returns the half-edges
// across which triangles changed charts, in order, for carry_frames().
std::vector<std::uint32_t> straighten_borders(const Topology& topology,
                                              const StraightenOptions& options,
                                              Partition& partition, const Context& context);

}  // namespace atlas
