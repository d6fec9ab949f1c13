// Internal: represents the chart borders of the whole mesh as chains that several charts share.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/simplify/fine_chart.h"

namespace atlas::simplify {

// A run of border edges along which the same charts meet. Each of these charts is a side of the
// chain. A seam has two sides, an open border has one, and a non-manifold edge has more. The two
// sides of a cut through one chart count as two. The end vertices of a chain stay. Every vertex
// between them is one fan of triangles in each side. A closed chain has no ends. A slot is the
// place of a vertex in a chain; it stands for one local vertex in each side.
struct BorderChain {
  std::uint32_t first_slot = 0, slot_count = 0;  // its vertices in their order along the chain
  std::uint32_t first_side = 0, side_count = 0;  // range of BorderChains::side_chart
  std::size_t first_vertex = 0;  // start of slot_count x side_count BorderChains::vertices
  bool closed = false;
};

struct BorderChains {
  std::vector<BorderChain> chains;        // only chains with a vertex that may be removed
  std::vector<std::uint32_t> slot_chain;  // the chain of each slot
  std::vector<std::uint32_t> side_chart;  // the chart of each side
  std::vector<std::uint32_t> vertices;  // local vertices of these charts, sides of a slot together

  std::uint32_t vertex(const BorderChain& chain, std::uint32_t slot, std::uint32_t side) const {
    return vertices[chain.first_vertex + std::size_t{slot - chain.first_slot} * chain.side_count +
                    side];
  }
};

BorderChains find_border_chains(const Geometry& geometry, const std::vector<FineChart>& charts);

}  // namespace atlas::simplify
