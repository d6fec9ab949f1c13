// Internal: the triangles of each piece or cell of a mesh.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/counting_sort.h"

namespace atlas {

// The triangles with each of the labels 0 .. count - 1, in order of id. Others have no label.
struct TriangleLists {
  std::vector<std::uint32_t> first, triangles;

  TriangleLists(std::span<const std::uint32_t> label, std::size_t count) {
    Buckets sorted = sort_into_buckets(label.size(), count + 1, [&](std::size_t t) {
      return std::min<std::size_t>(label[t], count);
    });
    first = std::move(sorted.begin);
    triangles = std::move(sorted.items);
    first.pop_back();
    triangles.resize(first.back());
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(first.size() - 1); }
  std::span<const std::uint32_t> of(std::uint32_t label) const {
    return {triangles.data() + first[label], first[label + 1] - first[label]};
  }
};

struct PieceList : TriangleLists {
  explicit PieceList(const Topology& topology)
      : TriangleLists(topology.component, topology.component_count) {}
};

}  // namespace atlas
