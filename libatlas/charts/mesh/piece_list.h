// Internal: the triangles of each piece of a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// The triangles of each piece, in order of id.
struct PieceList {
  std::vector<std::uint32_t> first, triangles;

  explicit PieceList(const Topology& topology) : first(topology.component_count + 2, 0) {
    const auto n = static_cast<std::uint32_t>(topology.triangle_count());
    for (std::uint32_t t = 0; t < n; ++t) {
      if (topology.component[t] != kNoIndex) ++first[topology.component[t] + 2];
    }
    for (std::size_t i = 2; i < first.size(); ++i) first[i] += first[i - 1];
    triangles.resize(first.back());
    for (std::uint32_t t = 0; t < n; ++t) {
      if (topology.component[t] != kNoIndex) triangles[first[topology.component[t] + 1]++] = t;
    }
    first.pop_back();
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(first.size() - 1); }
  std::span<const std::uint32_t> of(std::uint32_t piece) const {
    return {triangles.data() + first[piece], first[piece + 1] - first[piece]};
  }
};

}  // namespace atlas
