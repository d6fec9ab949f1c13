// Internal: straightens the border between two charts, by minimum cuts in a band along it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/seams/min_cut.h"
#include "libatlas/charts/seams/straighten.h"

namespace atlas {

// The data that pairs processed in parallel share. Each pair reads and writes only the triangles of
// its own charts; of other triangles it sees only that they belong to others.
struct SharedBands {
  const Topology& topology;
  const BorderRules& rules;
  std::span<const std::uint8_t> rings;  // one per chart
  Partition& partition;
  std::span<std::uint32_t> places;  // one per triangle: its index in the band of its pair, or
                                    // kNoIndex
};

struct BorderPair {
  std::array<std::uint32_t, 2> charts;
  // One half-edge for both sides; some may no longer be on the border.
  std::span<const std::uint32_t> border;
};

struct PairScratch {
  std::vector<std::uint32_t> band, list, fans;
  MinCut cut;
};

// Straightens the border. Returns the half-edges across which triangles changed charts, in order.
std::vector<std::uint32_t> straighten_pair(const SharedBands& shared, const BorderPair& pair,
                                           PairScratch& scratch);

}  // namespace atlas
