// A mesh as one chart.
#pragma once

#include <gtest/gtest.h>

#include <numeric>
#include <utility>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {

struct Whole {
  explicit Whole(const Shape& shape) {
    const Mesh mesh(shape);
    Result<Topology> built = build_topology(mesh.view(), {}, {});
    EXPECT_TRUE(built.ok());
    topology = std::move(*built);
    const std::size_t n = topology.triangle_count();
    partition.chart.assign(n, 0);
    partition.seams.assign(n, 0);
    partition.local.resize(n);
    triangles.resize(n);
    std::iota(triangles.begin(), triangles.end(), 0u);
  }

  Topology topology;
  Partition partition;
  std::vector<std::uint32_t> triangles;
};

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
