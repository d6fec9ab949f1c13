// Internal: chart borders of the whole mesh as chains that several charts share.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/simplify/fine_chart.h"

namespace atlas::simplify {

// A run of border edges along which the same charts (sides) meet: two for a seam, one for an open
// border, more at a non-manifold edge; the two sides of a cut through one chart count as two.
// Between its ends (which stay) every vertex is one fan in each side. A closed chain has no ends.
struct BorderChain {
  std::uint32_t first_slot = 0, slot_count = 0;  // its vertices in order
  std::uint32_t first_side = 0, side_count = 0;  // range of BorderChains::side_chart
  std::size_t first_vertex = 0;  // of BorderChains::vertices: slot_count x side_count
  bool closed = false;
};

struct BorderChains {
  std::vector<BorderChain> chains;        // those with a vertex that may go
  std::vector<std::uint32_t> slot_chain;  // 1 a slot
  std::vector<std::uint32_t> side_chart;  // charts
  std::vector<std::uint32_t> vertices;  // local vertices of these charts, sides of a slot together

  std::uint32_t vertex(const BorderChain& chain, std::uint32_t slot, std::uint32_t side) const {
    return vertices[chain.first_vertex + std::size_t{slot - chain.first_slot} * chain.side_count +
                    side];
  }
};

BorderChains find_border_chains(const Geometry& geometry, const std::vector<FineChart>& charts);

}  // namespace atlas::simplify
