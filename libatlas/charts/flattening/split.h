// Internal: ways to make a chart flatten: cutting it open, or dividing it.
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

// Returns two local triangles far from each other, or {0, 0} for a single triangle.
std::array<std::uint32_t, 2> far_pair(const Topology& topology, const LocalChart& chart);

// Divides a connected chart by growing regions from the given local triangles, at least two
// different ones, at equal speed (slower across creases). Returns one label per triangle; the
// triangles of each label are connected. Polygons stay whole, and labels may then fall apart,
// unless the chart is a single polygon.
std::vector<std::uint8_t> divide(const Topology& topology, const LocalChart& chart,
                                 std::span<const std::uint32_t> seeds);

// Joins boundary loops of a connected chart to its first loop and those joined to that, nearest
// first, by shortest paths along edges (creases count less). The half-edges of the paths become
// seams. Joins at least one loop, and continues until all `wanted` ones (of chart.loops) are
// joined. Returns false if there is only one loop.
bool join_loops(const Topology& topology, const LocalChart& chart,
                std::span<const std::uint32_t> wanted, Partition& partition);

// The edges of cuts to single vertices, each named by its lower half-edge.
struct Darts {
  std::unordered_set<std::uint32_t> cut;     // all that were cut, including those closed since
  std::unordered_set<std::uint32_t> closed;  // those closed since

  // Cuts a disc open from its border to the vertex, of those in the offending triangles (local
  // ids), where curvature is most concentrated, and possibly to further sharp ones. It stays a
  // disc. Returns false if there is no such vertex inside.
  bool cut_to_border(const Topology& topology, const LocalChart& chart,
                     std::span<const std::uint32_t> offenders, Partition& partition);

  // Closes darts inside a chart where their banks cross, and those that then lead to no tip. The
  // remainder of a dart is a slit that does not reach the border. Other cuts stay, since they may
  // be what makes the chart a disc. Returns false if no dart is there.
  bool close_crossed(const Topology& topology, const LocalChart& chart,
                     std::span<const BorderCrossing> crossings, Partition& partition);
};

// Closes cuts inside a chart whose banks lie on each other in `uvs`, since they are no longer
// needed. Returns false if there are none.
bool close_flat_slits(const Topology& topology, const LocalChart& chart, std::span<const Vec2d> uvs,
                      Partition& partition);

// Finds boundary loops inside the outline that run around it in the wrong direction, as those of
// cuts do whose banks have changed sides without crossing. Returns the triangles along them, each
// as a crossing with itself.
std::vector<BorderCrossing> turned_loops(const LocalChart& chart, std::span<const Vec2d> uvs);

}  // namespace atlas
