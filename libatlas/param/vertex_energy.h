// Internal: energies of a triangle's map J, by f = |J|² and d = det J (relax.h says what they are
// for), and their derivatives.
#pragma once

#include <cmath>
#include <limits>

namespace atlas::param {

// Partial derivatives of a triangle's energy by f and d.
struct EnergyDerivatives {
  double f, d, dd, fd, ff = 0;
};

inline double untangling(double f, double d, double epsilon) {
  const double chi = 0.5 * (d + std::sqrt(d * d + epsilon * epsilon));
  return (f + 1 + d * d) / chi;
}

inline EnergyDerivatives untangling_derivatives(double f, double d, double epsilon) {
  const double root = std::sqrt(d * d + epsilon * epsilon);
  // For negative d the sum cancels; this form of it does not.
  const double chi = d > 0 ? 0.5 * (d + root) : 0.5 * epsilon * epsilon / (root - d);
  const double chi1 = chi / root, chi2 = 0.5 * epsilon * epsilon / (root * root * root);
  const double n = f + 1 + d * d, inverse = 1 / chi, squared = inverse * inverse;
  EnergyDerivatives out;
  out.f = inverse;
  out.fd = -chi1 * squared;
  out.d = 2 * d * inverse + n * out.fd;
  out.dd = 2 * inverse - 4 * d * chi1 * squared +
           n * (2 * chi1 * chi1 * squared * inverse - chi2 * squared);
  return out;
}

inline double symmetric_dirichlet(double f, double d) {
  return d > 0 ? f * (1 + 1 / (d * d)) : std::numeric_limits<double>::infinity();
}

inline EnergyDerivatives symmetric_dirichlet_derivatives(double f, double d) {
  const double i = 1 / d, i2 = i * i;
  return {1 + i2, -2 * f * i2 * i, 6 * f * i2 * i2, -2 * i2 * i, 0};
}

// The sum of the 2q-th powers of the singular values and of their inverses, q = 2^doublings. With
// the 16th power charts under scan noise end just beyond a bound of 1.25, with the 64th within it.
inline constexpr int doublings = 5;

inline double high_power(double f, double d) {
  if (!(d > 0)) return std::numeric_limits<double>::infinity();
  double sum = f, product = d * d;  // of the q-th powers of the squared singular values
  for (int i = 0; i < doublings; ++i) {
    sum = sum * sum - 2 * product;
    product *= product;
  }
  return sum * (1 + 1 / product);
}

inline EnergyDerivatives high_power_derivatives(double f, double d) {
  // The sum of q-th powers with its derivatives by f and D = d², the product with those by D.
  const double D = d * d;
  double sum = f, sum_f = 1, sum_D = 0, sum_ff = 0, sum_fD = 0, sum_DD = 0, product = D, q = 1;
  for (int i = 0; i < doublings; ++i) {
    const double product_D = q * product / D, product_DD = (q - 1) * product_D / D;
    sum_ff = 2 * (sum_f * sum_f + sum * sum_ff);
    sum_fD = 2 * (sum_f * sum_D + sum * sum_fD);
    sum_DD = 2 * (sum_D * sum_D + sum * sum_DD - product_DD);
    sum_f = 2 * sum * sum_f;
    sum_D = 2 * (sum * sum_D - product_D);
    sum = sum * sum - 2 * product;
    product *= product;
    q *= 2;
  }
  const double inverse = 1 / product, inverse_D = -q * inverse / D;
  const double inverse_DD = -(q + 1) * inverse_D / D, both = 1 + inverse;
  const double e_D = sum_D * both + sum * inverse_D;
  const double e_DD = sum_DD * both + 2 * sum_D * inverse_D + sum * inverse_DD;
  return {sum_f * both, 2 * d * e_D, 2 * e_D + 4 * D * e_DD,
          2 * d * (sum_fD * both + sum_f * inverse_D), sum_ff * both};
}

}  // namespace atlas::param
