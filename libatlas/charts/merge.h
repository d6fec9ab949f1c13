// Internal: charts from micro-cells, by greedy merging.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/coarse.h"
#include "libatlas/charts/cone.h"
#include "libatlas/charts/trial.h"
#include "libatlas/core/context.h"

namespace atlas {

struct MergeOptions {
  TrialLimits limits;
  double cone = 0;                               // limit on a chart's normals, radians; 0: none
  const ExtremeNormals* cell_normals = nullptr;  // needed when there is a limit
  double compactness_weight = 0.15;
  double seam_worth = 1.0 / 800;
  double small_share = 0.01, small_solidity = 0.6, small_fill = 0.5, chart_worth = 0.3;
  double tail_worth = 0.0015;
  double crease_weight = 0.15;
};

// What merging may cost follows the bound asked for, or a wide bound would save no chart, and a
// narrow one would be met by cutting afterwards: stretch in proportion to the bound's excess over
// 1, losses of area to its square. Below the default, half as fast, for the fine flattening
// is better than the coarse one that merging tries.
MergeOptions merge_options(double max_stretch);

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
