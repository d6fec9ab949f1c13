// Flattens a mesh as one chart.
#pragma once

#include <gtest/gtest.h>

#include "libatlas/charts/flattening/flatten.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {

inline FlattenResult flatten_whole(const Shape& shape, const ChartOptions& options = {}) {
  const Mesh mesh(shape);
  const Result<Topology> topology = build_topology(mesh.view(), {}, {});
  EXPECT_TRUE(topology.ok());
  Partition partition;
  partition.chart.assign(shape.triangle_count(), 0);
  Frames frames;
  return flatten_charts({*topology, {}, options, frames}, partition, {});
}

}  // namespace atlas::test
