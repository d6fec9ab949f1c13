// How far a flattening is from an isometry.
#pragma once

#include <cstdint>

namespace atlas {

// Area-weighted over the surface, at the set's own area-preserving scale. s1 >= s2 are the singular
// values of the uv-to-surface map (Sander et al. 2001); 1 is perfect everywhere.
struct Distortion {
  double stretch_l2 = 1;        // sqrt of the mean of (s1² + s2²) / 2
  double stretch_linf = 1;      // largest max(s1, 1/s2)
  double stretch_999 = 1;       // max(s1, 1/s2) that 99.9 % of the area stays within
  double conformal_mean = 1;    // mean of s1 / s2
  double conformal_max = 1;
  double area_min = 1, area_max = 1;  // extremes of s1 s2 (surface area per uv area)
  double surface_area = 0;
  double uv_area = 0;
  std::uint64_t flips = 0;       // triangles with the wrong sign in uv
  std::uint64_t degenerate = 0;  // triangles with zero uv area but not zero surface area
};

}  // namespace atlas
