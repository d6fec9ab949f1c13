#include "libatlas/charts/totals.h"

#include <algorithm>
#include <cmath>

namespace atlas {

Distortion total_distortion(std::span<const Chart> charts) {
  Distortion total;
  double l2 = 0, conformal = 0, area = 0;
  for (const Chart& chart : charts) {
    const Distortion& d = chart.distortion;
    l2 += d.stretch_l2 * d.stretch_l2 * d.surface_area;
    conformal += d.conformal_mean * d.surface_area;
    area += d.surface_area;
    total.stretch_linf = std::max(total.stretch_linf, d.stretch_linf);
    total.stretch_999 = std::max(total.stretch_999, d.stretch_999);
    total.conformal_max = std::max(total.conformal_max, d.conformal_max);
    total.area_min = std::min(total.area_min, d.area_min);
    total.area_max = std::max(total.area_max, d.area_max);
    total.uv_area += d.uv_area;
    total.flips += d.flips;
    total.degenerate += d.degenerate;
  }
  total.surface_area = area;
  if (area > 0) {
    total.stretch_l2 = std::sqrt(l2 / area);
    total.conformal_mean = conformal / area;
  }
  return total;
}

}  // namespace atlas
