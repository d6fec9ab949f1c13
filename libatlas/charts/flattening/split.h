// Internal: how a chart that cannot be flattened is made easier.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/param/injectivity.h"

namespace atlas {

// Two local triangles far from each other, or {0, 0} for a single triangle.
std::array<std::uint32_t, 2> far_pair(const Topology& topology, const LocalChart& chart);

// Grows the chart's triangles from the given local ones, at least two different, at equal speed
// (slower across creases); returns 1 label a triangle, each label's triangles connected. The chart
// is connected.
std::vector<std::uint8_t> divide(const Topology& topology, const LocalChart& chart,
                                 std::span<const std::uint32_t> seeds);

// Local triangles around one side of each crossing, the one with fewer neighbours, with so many
// rings of neighbours: what may go to other charts so that the border does not cross itself.
std::vector<std::uint32_t> around_crossings(const LocalChart& chart,
                                            std::span<const BorderCrossing> crossings, int rings);

// Joins border loops of a connected chart to its first one and to what is joined to that, nearest
// first, by shortest paths of edges (creases are shorter), marking their half-edges as seams: until
// all wanted ones (of chart.loops) are joined, but at least one. False if there is only one loop.
bool join_loops(const Topology& topology, const LocalChart& chart,
                std::span<const std::uint32_t> wanted, Partition& partition);

// Cuts to single vertices, as edges by their lower half-edge.
struct Darts {
  std::unordered_set<std::uint32_t> cut;     // whether closed since or not
  std::unordered_set<std::uint32_t> closed;  // of them
};

// Cuts a disc open from its border to the vertex among the offending triangles' (local ids) where
// curvature is most concentrated; it stays a disc. Notes the edges. False if there is none inside.
bool cut_to_border(const Topology& topology, const LocalChart& chart,
                   std::span<const std::uint32_t> offenders, Darts& darts, Partition& partition);

// Ways to cut a disc open from its border, as half-edges of the chart from their ends on: to the
// sharpest tip among the triangles (local ids), and to the vertex that is farthest inside, if it is
// another tip. Tips have less than the full angle around them; cuts to others let a chart overlap
// itself.
std::vector<std::vector<std::uint32_t>> ways_to_tips(const Topology& topology,
                                                     const LocalChart& chart,
                                                     std::span<const std::uint32_t> triangles);

// Closes darts inside a chart where their banks cross, and those that then lead to no tip: what is
// left of a dart is a slit that does not reach the border. Other cuts stay, for they may be what
// makes the chart a disc. False if no dart is there.
bool close_cuts(const Topology& topology, const LocalChart& chart,
                std::span<const BorderCrossing> crossings, Partition& partition, Darts& darts);

// Closes cuts inside a chart whose banks lie upon each other in `uvs`: it needs them no more. False
// if there is none.
bool close_flat_slits(const Topology& topology, const LocalChart& chart, std::span<const Vec2d> uvs,
                      Partition& partition);

// The triangles along border loops inside the outline that run around it the wrong way, each as a
// crossing with itself: of cuts whose banks have changed sides without crossing.
std::vector<BorderCrossing> turned_loops(const LocalChart& chart, std::span<const Vec2d> uvs);

}  // namespace atlas
