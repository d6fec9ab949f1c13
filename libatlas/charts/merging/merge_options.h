// Internal: what merging charts may cost.
#pragma once

#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/merging/trial.h"

namespace atlas {

// Lengths are in square roots of the piece's area, areas in shares of it.
struct MergeOptions {
  TrialLimits limits;
  double cone = 0;                               // limit on a chart's normals, radians; 0: none
  const ExtremeNormals* cell_normals = nullptr;  // needed when there is a limit
  // In the order of merging, beside the spread of the normals: a long outline, creases between.
  double compactness_weight = 0.15, crease_weight = 0.15;
  // What a length of seam is worth: area times (L2 stretch squared - 1), and area stretched beyond
  // TrialLimits::stretch_high.
  double seam_worth = 1.0 / 800, tail_worth = 0.002;
  // In a second pass, charts below this share of the area may fill hull and rectangle less, and to
  // be rid of one is worth this length of seam.
  double small_share = 0.01, small_solidity = 0.6, small_fill = 0.5, chart_worth = 0.3;
};

// What merging may cost follows the bound asked for, or a wide bound would save no chart, and a
// narrow one would be met by cutting afterwards: stretch in proportion to the bound's excess over
// 1, losses of area to its square. Below the default, half as fast, for the fine flattening
// is better than the coarse one that merging tries.
MergeOptions merge_options(double max_stretch);

}  // namespace atlas
