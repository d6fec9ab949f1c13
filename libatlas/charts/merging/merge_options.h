// Internal: options of merging, which say what mergers may cost.
#pragma once

#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/merging/trial.h"

namespace atlas {

// Lengths are in square roots of the piece's area, areas in shares of it.
struct MergeOptions {
  TrialLimits limits;
  double cone = 0;                               // limit on a chart's normals, radians; 0: none
  const ExtremeNormals* cell_normals = nullptr;  // needed with a cone limit
  // Weights in the cost that orders mergers, beside the spread of the normals: of a long outline,
  // and of creases in between.
  double compactness_weight = 0.15, crease_weight = 0.2;
  // What a unit of seam (border_weight) is worth: in area times (L2 stretch squared - 1), and in
  // area stretched beyond TrialLimits::stretch_high.
  double seam_worth = 1.0 / 320, tail_worth = 0.005;
  // In a second pass, charts below this share of the area may fill less of their hull and
  // rectangle. Removing one of them is worth as much as this length of seam.
  double small_share = 0.01, small_solidity = 0.6, small_fill = 0.5, chart_worth = 0.3;
};

// Returns the options for a bound on stretch. What mergers may cost follows the bound: otherwise a
// wide bound would save no charts, and a narrow one would be met only by cutting afterwards. The
// limit on high stretch is proportional to the bound's excess over 1, and losses of area are to its
// square. Below the default the limits fall half as fast, since the fine flattening is better than
// the coarse one that merging tries.
MergeOptions merge_options(double max_stretch);

}  // namespace atlas
