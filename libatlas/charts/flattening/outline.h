// Internal: the outline of a flat chart, that is, its border and convex hull.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

struct Outline {
  struct Edge {
    std::uint32_t half_edge;
    Vec2d from, to;
  };
  std::vector<Edge> edges;  // border edges, including seams of the chart with itself
  std::vector<Vec2d> hull;  // corners of the convex hull, counter-clockwise
};

// Returns the outline in the chart's uvs. `partition` must be the one that the chart was flattened
// with.
Outline outline_of(const Topology& topology, const Partition& partition, const FlatChart& chart);

// Returns how many pairs of an edge of `a` and an edge of `b` cross, but at most `most`.
std::size_t count_crossings(std::span<const Outline::Edge> a, std::span<const Outline::Edge> b,
                            std::size_t most);

}  // namespace atlas
