// Internal: flattens every chart of a partition, cutting and splitting those that resist.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/charts/seams/refine.h"
#include "libatlas/core/context.h"

namespace atlas {

// A chart that is done. Lengths in units of the topology (scaled), times density.
struct FlatChart {
  std::vector<std::uint32_t> triangles;               // ascending
  std::vector<std::array<std::uint32_t, 3>> corners;  // 1 a triangle, into uvs; working order
  std::vector<std::uint32_t> vertex;                  // 1 a uv: of the topology
  std::vector<Vec2d> uvs;
  NormalCone cone;
  Distortion distortion;
  Vec2d size;
  bool planar = false;
  bool kept = false;      // given, not flattened
  bool fragment = false;  // of a chart that was divided, or left over by a limit on cones

  // What it stretches, by its area.
  double excess() const { return distortion.stretch_l2 * distortion.stretch_l2 - 1; }
  double box_area() const { return size.x * size.y; }
};

struct FlattenInput {
  const Topology& topology;
  std::span<const float> density;  // 1 a triangle, or empty
  const ChartOptions& options;
  // Where the solver starts, or empty; triangles that change charts get new ones.
  Frames& frames;
};

struct FlattenResult {
  std::vector<FlatChart> charts;   // ordered by first triangle
  std::uint64_t split_charts = 0;  // that failed and were cut into smaller ones
  ChartSet::Timing timing;         // the parts of parameterisation so far
};

// Adds the parts, not the two sums, of one to the other.
void add_parts(const ChartSet::Timing& parts, ChartSet::Timing& sum);

// Every triangle with a chart in `partition` ends in exactly one FlatChart; each is injective,
// within the stretch bound and, if asked for, within the cone. `partition` is left as it came out
// in the end. Charts run in parallel; the result does not depend on how.
FlattenResult flatten_charts(const FlattenInput& input, Partition& partition,
                             const Context& context);

}  // namespace atlas
