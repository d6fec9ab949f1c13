// Internal: flattens every chart of a partition, and cuts or divides those that cannot be
// flattened.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/charts/seams/refine.h"
#include "libatlas/core/context.h"

namespace atlas {

// A flat chart. Lengths are in units of the topology (scaled), times density.
struct FlatChart {
  std::vector<std::uint32_t> triangles;               // ascending
  std::vector<std::array<std::uint32_t, 3>> corners;  // one per triangle, into uvs; working order
  std::vector<std::uint32_t> vertex;                  // one per uv: vertex of the topology
  std::vector<Vec2d> uvs;
  NormalCone cone;
  Distortion distortion;
  Vec2d size;
  bool planar = false;
  bool kept = false;      // the given uvs' shape, not flattened
  bool fragment = false;  // part of a divided chart, or any chart under a cone limit

  // What its stretch costs, relative to its area.
  double excess() const { return distortion.stretch_l2 * distortion.stretch_l2 - 1; }
  double box_area() const { return size.x * size.y; }
  // The connected piece of the mesh that it belongs to.
  std::uint32_t piece(const Topology& topology) const {
    return topology.component[triangles.front()];
  }
};

struct FlattenInput {
  const Topology& topology;
  std::span<const float> density;  // one per triangle, or empty
  const ChartOptions& options;
  // Where the solver starts, or empty. Triangles that change charts get new frames.
  Frames& frames;
};

struct FlattenResult {
  std::vector<FlatChart> charts;      // ordered by first triangle
  std::vector<std::uint32_t> splits;  // one per piece: charts that failed and were divided
  ChartSet::Timing timing;            // the parts of parameterization so far

  std::uint64_t split_charts() const {
    return std::accumulate(splits.begin(), splits.end(), std::uint64_t{0});
  }
};

// Adds the parts of parameterization, but not the two totals, to `sum`.
void add_parts(const ChartSet::Timing& parts, ChartSet::Timing& sum);

// Flattens all charts. Every triangle with a chart in `partition` ends up in exactly one FlatChart;
// each is injective, within the stretch bound and, if there is a limit, within the cone.
// `partition` is changed to the final charts. Charts run in parallel; the result does not depend on
// the number of threads.
FlattenResult flatten_charts(const FlattenInput& input, Partition& partition,
                             const Context& context);

}  // namespace atlas
