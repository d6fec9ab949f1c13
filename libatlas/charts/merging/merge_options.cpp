#include "libatlas/charts/merging/merge_options.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/charts.h"

namespace atlas {
namespace {

constexpr double kWidestRatio = 1e6;  // keeps the limits finite
// Bounds narrower than 1.025 allow no fewer mergers. Below that, the fan's own error on a mesh that
// unrolls exactly exceeds what merging would allow. With a bound of 1.001, cylinders came out in 9
// to 39 charts; if this ratio is 0.1 or more, in one or two, while spheres need a thirtieth more.
constexpr double kLeastRatio = 0.1;

}  // namespace

MergeOptions merge_options(double max_stretch) {
  MergeOptions merge;
  const double usual = ChartOptions{}.max_stretch;
  if (max_stretch == usual) return merge;
  double ratio = std::min((max_stretch - 1) / (usual - 1), kWidestRatio);
  if (ratio < 1) ratio = std::sqrt(std::max(ratio, kLeastRatio));
  merge.limits.stretch_high = 1 + (merge.limits.stretch_high - 1) * ratio;
  merge.limits.stretch_l2 = 1 + (merge.limits.stretch_l2 - 1) * ratio * ratio;
  merge.seam_worth *= ratio * ratio;
  merge.tail_worth *= std::max(1.0, ratio);
  merge.limits.far_apart *= std::max(1.0, ratio);
  return merge;
}

}  // namespace atlas
