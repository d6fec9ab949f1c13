// Internal: divides a mesh into charts that are not flat yet.
#pragma once

#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/charts/seams/refine.h"
#include "libatlas/core/context.h"

namespace atlas {

struct Segmentation {
  Partition partition;
  Frames frames;            // may be empty
  ChartSet::Timing timing;  // the parts of segmentation after the topology
};

// Segments each component by itself. Texcoords are not used. `first_seed` is
// CellOptions::first_seed.
Segmentation segment(const Topology& topology, const ChartOptions& options, double first_seed,
                     const Context& context);

}  // namespace atlas
