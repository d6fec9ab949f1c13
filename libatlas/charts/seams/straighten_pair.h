// Internal: the border between two charts drawn straight, by minimum cuts in a band along it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/seams/min_cut.h"
#include "libatlas/charts/seams/straighten.h"

namespace atlas {

// What pairs at work at once have in common. Each reads and writes its own charts' triangles alone;
// of others it sees no more than that they are.
struct SharedBands {
  const Topology& topology;
  const BorderRules& rules;
  std::span<const SeamBand> bands;  // 1 a chart
  Partition& partition;
  std::span<std::uint32_t> places;  // 1 a triangle, kNoIndex: its place in the band at work
};

struct BorderPair {
  std::array<std::uint32_t, 2> charts;
  std::span<const std::uint32_t> border;  // half-edges, one for both sides; some may be none by now
};

struct PairScratch {
  std::vector<std::uint32_t> band, list, fans;
  std::vector<std::uint8_t> visited;  // 1 a triangle of the part
  MinCut cut;
};

// Returns the half-edges across which triangles came to the other chart, in order.
std::vector<std::uint32_t> straighten_pair(const SharedBands& shared, const BorderPair& pair,
                                           PairScratch& scratch);

}  // namespace atlas
