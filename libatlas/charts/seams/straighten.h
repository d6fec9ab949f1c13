// Internal: seams drawn straight, by minimum cuts in a band along them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/seams/refine.h"
#include "libatlas/core/context.h"

namespace atlas {

// How far the seams of a chart may move.
struct SeamBand {
  std::uint8_t rings = 0;  // so many triangles to each side; 0: they stay
  // A triangle that changes sides must save this part of its own size in seam. With less, seams are
  // shorter and charts stretch more.
  float stiffness = 0.3F;
};

struct StraightenOptions {
  BorderRules rules;
  std::span<const SeamBand> bands;             // 1 a chart
  std::span<const std::uint32_t> triangles{};  // of all charts with rings; empty: of all charts
};

// Replaces the border between each two charts by the shortest one (creases count a quarter) within
// the narrower and stiffer of their bands, found as a minimum cut of the dual graph (the idea: Katz
// and Tal 2003). Where single triangles cannot shorten a border, as on the steps of a
// staircase, this can. A border stays as it is where a chart would come apart, close to a ring or
// leave its cone. Borders between different charts are straightened at once.
// Returns the half-edges across which triangles changed charts, in order, for carry_frames().
std::vector<std::uint32_t> straighten_borders(const Topology& topology,
                                              const StraightenOptions& options,
                                              Partition& partition, const Context& context);

}  // namespace atlas
