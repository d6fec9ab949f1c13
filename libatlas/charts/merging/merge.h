// Internal: charts from micro-cells, by greedy merging.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/merge_options.h"
#include "libatlas/charts/merging/trial.h"
#include "libatlas/core/context.h"

namespace atlas {

struct MergeResult {
  std::vector<std::uint32_t> chart_of_cell;
  std::vector<std::uint8_t> joined;  // 1 an arc: its sides are one edge of one chart
  std::vector<Vec3f> chart_axis;     // by chart_of_cell; only with a cone limit
  CoarseUv uv;                       // every chart's coarse flattening
  std::uint64_t trials = 0, rejections = 0;
};

// Merges neighbouring charts, cheapest first: small spread of the normals off a great circle
// (smallest eigenvalue of their covariance: what unrolls), compact outline, no crease between. Each
// merge is tried on the coarse mesh first. `piece` (1 a cell) names the connected piece of the mesh
// that a cell lies in; pieces are merged in parallel.
MergeResult merge_cells(const CoarseMesh& mesh, const std::vector<std::uint32_t>& piece,
                        const MergeOptions& options, const Context& context);

}  // namespace atlas
