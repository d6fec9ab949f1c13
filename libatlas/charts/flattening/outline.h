// Internal: what of a flat chart its surroundings see.
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
  std::vector<Edge> edges;  // of the border; seams of the chart with itself are part of it
  std::vector<Vec2d> hull;  // corners of the convex hull, counter-clockwise
};

// In the chart's uvs. `partition` is the one that the chart has been flattened with.
Outline outline_of(const Topology& topology, const Partition& partition, const FlatChart& chart);

// How many pairs of an edge of `a` and one of `b` cross, but no more than `most` are counted.
std::size_t count_crossings(std::span<const Outline::Edge> a, std::span<const Outline::Edge> b,
                            std::size_t most);

}  // namespace atlas
