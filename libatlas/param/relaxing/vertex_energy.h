// Internal: energies of a triangle's map J as functions of f = |J|² and d = det J (see relax.h for
// their uses), and their derivatives; for a double, or for several triangles at once.
#pragma once

#include <cmath>
#include <limits>

#include "libatlas/core/wide_vectors.h"

// Everything here is inlined, so how Quads are passed does not matter.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace atlas::param {

#define ATLAS_ENERGY    \
  template <class Real> \
  [[gnu::always_inline]] inline

// Partial derivatives of a triangle's energy with respect to f and d.
template <class Real>
struct EnergyDerivatives {
  Real f, d, dd, fd, ff{};
};

ATLAS_INLINE double root_of(const double& x) {
  return std::sqrt(x);
}
ATLAS_INLINE Quad root_of(const Quad& x) {
  return Quad{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

// Returns `energy` where d is positive, otherwise infinity.
ATLAS_ENERGY Real where_positive(const Real& d, const Real& energy) {
  const Real infinite = std::numeric_limits<double>::infinity() + Real{};
  return d > 0 ? energy : infinite;
}

ATLAS_ENERGY Real untangling(const Real& f, const Real& d, double epsilon) {
  const Real chi = 0.5 * (d + root_of(d * d + epsilon * epsilon));
  return (f + 1 + d * d) / chi;
}

ATLAS_ENERGY EnergyDerivatives<Real> untangling_derivatives(const Real& f, const Real& d,
                                                            double epsilon) {
  const Real root = root_of(d * d + epsilon * epsilon);
  // For negative d the sum cancels; the second form does not.
  const Real plain = 0.5 * (d + root), other = 0.5 * epsilon * epsilon / (root - d);
  const Real chi = d > 0 ? plain : other;
  const Real chi1 = chi / root, chi2 = 0.5 * epsilon * epsilon / (root * root * root);
  const Real n = f + 1 + d * d, inverse = 1 / chi, squared = inverse * inverse;
  EnergyDerivatives<Real> out;
  out.f = inverse;
  out.fd = -chi1 * squared;
  out.d = 2 * d * inverse + n * out.fd;
  out.dd = 2 * inverse - 4 * d * chi1 * squared +
           n * (2 * chi1 * chi1 * squared * inverse - chi2 * squared);
  return out;
}

ATLAS_ENERGY Real symmetric_dirichlet(const Real& f, const Real& d) {
  return where_positive<Real>(d, f * (1 + 1 / (d * d)));
}

ATLAS_ENERGY EnergyDerivatives<Real> symmetric_dirichlet_derivatives(const Real& f, const Real& d) {
  const Real i = 1 / d, i2 = i * i;
  return {1 + i2, -2 * f * i2 * i, 6 * f * i2 * i2, -2 * i2 * i, Real{}};
}

// The sum of the 2q-th powers of the singular values and of their inverses, q = 2^doublings. With
// the 16th power charts under scan noise end just beyond a bound of 1.25, with the 64th within it.
inline constexpr int doublings = 5;

ATLAS_ENERGY Real high_power(const Real& f, const Real& d) {
  Real sum = f, product = d * d;  // of the q-th powers of the squared singular values
  for (int i = 0; i < doublings; ++i) {
    sum = sum * sum - 2 * product;
    product *= product;
  }
  return where_positive<Real>(d, sum * (1 + 1 / product));
}

ATLAS_ENERGY EnergyDerivatives<Real> high_power_derivatives(const Real& f, const Real& d) {
  // The sum of q-th powers with its derivatives by f and D = d², and the product with those by D.
  const Real D = d * d;
  Real sum = f, sum_f = 1 + Real{}, sum_D{}, sum_ff{}, sum_fD{}, sum_DD{}, product = D;
  double q = 1;
  for (int i = 0; i < doublings; ++i) {
    const Real product_D = q * product / D, product_DD = (q - 1) * product_D / D;
    sum_ff = 2 * (sum_f * sum_f + sum * sum_ff);
    sum_fD = 2 * (sum_f * sum_D + sum * sum_fD);
    sum_DD = 2 * (sum_D * sum_D + sum * sum_DD - product_DD);
    sum_f = 2 * sum * sum_f;
    sum_D = 2 * (sum * sum_D - product_D);
    sum = sum * sum - 2 * product;
    product *= product;
    q *= 2;
  }
  const Real inverse = 1 / product, inverse_D = -q * inverse / D;
  const Real inverse_DD = -(q + 1) * inverse_D / D, both = 1 + inverse;
  const Real e_D = sum_D * both + sum * inverse_D;
  const Real e_DD = sum_DD * both + 2 * sum_D * inverse_D + sum * inverse_DD;
  return {sum_f * both, 2 * d * e_D, 2 * e_D + 4 * D * e_DD,
          2 * d * (sum_fD * both + sum_f * inverse_D), sum_ff * both};
}

#undef ATLAS_ENERGY

}  // namespace atlas::param

#pragma GCC diagnostic pop
