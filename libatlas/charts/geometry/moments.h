// Internal: second moments of normals.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libatlas/core/portable_math.h"
#include "libatlas/core/vec.h"

namespace atlas {

using Moments = std::array<double, 6>;  // of a symmetric matrix: xx, xy, xz, yy, yz, zz

// Returns the covariance: the mean of products minus the products of the means.
inline Moments about(const Moments& m, const Vec3d& mean) {
  return {m[0] - mean.x * mean.x, m[1] - mean.x * mean.y, m[2] - mean.x * mean.z,
          m[3] - mean.y * mean.y, m[4] - mean.y * mean.z, m[5] - mean.z * mean.z};
}

// Method: Smith 1961, "Eigenvalues of a symmetric 3 x 3 matrix".
inline double smallest_eigenvalue(const Moments& m) {
  const double off = m[1] * m[1] + m[2] * m[2] + m[4] * m[4];
  const double mean = (m[0] + m[3] + m[5]) / 3;
  const double a = m[0] - mean, d = m[3] - mean, f = m[5] - mean;
  const double p = std::sqrt((a * a + d * d + f * f + 2 * off) / 6);
  if (!(p > 0)) return mean;
  const double det =
      a * (d * f - m[4] * m[4]) - m[1] * (m[1] * f - m[4] * m[2]) + m[2] * (m[1] * m[4] - d * m[2]);
  const double r = std::clamp(det / (2 * p * p * p), -1.0, 1.0);
  return mean + 2 * p * portable::cos(portable::acos(r) / 3 + 2 * std::numbers::pi / 3);
}

}  // namespace atlas
