// Internal: gathers flat charts into a ChartSet.
#pragma once

#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

struct ChartedTopology {
  const MeshView& mesh;  // in the topology's order
  const Topology& topology;
  double density;  // the factor that was taken out of the densities
};

// Fills what `set` says of charts and triangles, in the topology's order. Triangles without area
// that no chart holds get a place in one. The charts' memory is freed.
void assemble_charts(const ChartedTopology& charted, std::vector<FlatChart>& charts, ChartSet& set);

}  // namespace atlas
