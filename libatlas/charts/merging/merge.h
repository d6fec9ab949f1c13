// Internal: builds charts from micro-cells by greedy merging.
#pragma once

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
  std::vector<std::uint8_t> joined;  // one per arc: its sides are one edge within one chart
  std::vector<Vec3f> chart_axis;     // by chart_of_cell; only with a cone limit
  CoarseUv uv;                       // the coarse flattening of every chart
  std::uint64_t trials = 0, rejections = 0;
  std::uint64_t work = 0;  // of all pieces, in the unit of MergeBudget
};

// Merges neighbouring charts, cheapest first. The cost is low for a small spread of the normals off
// a great circle (the smallest eigenvalue of their covariance, which is low for surfaces that
// unroll), a compact outline, and no crease in between. Each merger is first tried on the coarse
// mesh. `piece` (one per cell) is the connected piece of the mesh that a cell lies in; pieces are
// merged in parallel.
MergeResult merge_cells(const CoarseMesh& mesh, const std::vector<std::uint32_t>& piece,
                        const MergeOptions& options, const Context& context);

}  // namespace atlas
