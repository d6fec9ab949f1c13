// Internal: ways to make a chart flatten: cutting it open, or dividing it.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/param/injectivity.h"

namespace atlas {

// Divides a connected chart of at least two triangles between two of them that are far from each
// other (across folds, more so), through the middle of the offending triangles (local ids; none:
// halfway): otherwise these come to lie in one part, which fails in its turn. Returns 0 or 1 per
// triangle; both parts are connected. Polygons stay whole, and parts may then fall apart, unless
// the chart is a single polygon.
std::vector<std::uint8_t> halves(const Topology& topology, const LocalChart& chart,
                                 std::span<const std::uint32_t> offenders);

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
