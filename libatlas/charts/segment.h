// Internal: the whole way from a mesh to a partition into charts.
#pragma once

#include <array>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/charts/seams/refine.h"
#include "libatlas/core/context.h"

namespace atlas {

struct Segmentation {
  Partition partition;
  Frames frames;            // or empty
  ChartSet::Timing timing;  // the parts of segmentation after the topology
};

// Each component on its own; texcoords play no part. `first_seed`: CellOptions::first_seed.
Segmentation segment(const Topology& topology, const ChartOptions& options, double first_seed,
                     const Context& context);

}  // namespace atlas
