// Internal: the Hessian of a function of a triangle's area, without its negative part.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace atlas {

// The corners of a triangle are x = (x0, y0, x1, y1, x2, y2). Twice its area is x'Kx / 2 with a
// constant K, whose eigenvalues are 0, and +-sqrt 3 twice each. This returns K y.
inline Eigen::Matrix<double, 6, 1> area_hessian_times(const Eigen::Matrix<double, 6, 1>& y) {
  return {y[3] - y[5], y[4] - y[2], y[5] - y[1], y[0] - y[4], y[1] - y[3], y[2] - y[0]};
}

// Returns the positive semidefinite part of bend * g g' - pull * K, the Hessian of a barrier f(A)
// in the corners of a triangle with twice the area A > 0: g = K x is the gradient of A, bend = f''
// >= 0 and pull = -f' >= 0.
//
// Let P and N be the projections onto the eigenvectors of K with the eigenvalues +sqrt 3 and
// -sqrt 3, and s = pull * sqrt 3. The Hessian maps the plane spanned by p = P g and n = N g onto
// itself. Orthogonal to that plane its eigenvalues are -s on P's part, which is left out, s on N's
// part, and 0. In the plane it is the 2x2 matrix
//   [ bend p'p - s       bend |p| |n| ]
//   [ bend |p| |n|       bend n'n + s ]
// with the eigenvalues high >= 0 and low. If low is negative, its part is taken off. The result is
// written with p and n instead of their directions, as n is 0 for equilateral triangles.
inline Eigen::Matrix<double, 6, 6> positive_barrier_hessian(const Eigen::Matrix<double, 6, 1>& g,
                                                            double bend, double pull) {
  using Vector = Eigen::Matrix<double, 6, 1>;
  const double root = std::sqrt(3.0), s = pull * root;
  const Vector turned = area_hessian_times(g) / root, p = (g + turned) / 2, n = (g - turned) / 2;
  const double pp = p.squaredNorm(), nn = n.squaredNorm();
  // Of p p' (a), of p n' + n p' (b) and of n n' (c), besides s N.
  double a = bend - (pp > 0 ? s / pp : 0), b = bend, c = bend;
  // The product of the eigenvalues in the plane is s times this.
  const double rest = bend * (pp - nn) - s;
  if (rest < 0) {
    const double half = bend * (pp + nn) / 2;
    const double high = half + std::sqrt(half * half - s * rest), low = s * rest / high;
    // The matrix minus low, times high / (high - low), is the part of high.
    const double share = high / (high - low);
    a = pp > 0 ? share * (bend * pp - s - low) / pp : 0;
    b = share * bend;
    // This is (share * (bend nn + s - low) - s) / nn without the cancellation for small nn.
    c = bend * (high - low * (high + s) / (high + s - bend * pp)) / (high - low);
  }
  Eigen::Matrix<double, 6, 6> h;
  h.noalias() = p * (a * p + b * n).transpose() + n * (b * p + c * n).transpose();
  // s N. The projection onto the moves that leave the centre in place is N + P.
  for (int i = 0; i < 6; ++i) {
    for (int j = i % 2; j < 6; j += 2) h(i, j) += s * ((i == j ? 0.5 : 0.0) - 1.0 / 6);
  }
  for (int k = 0; k < 3; ++k) {
    const int x = 2 * k, y = x + 1, next_x = (x + 2) % 6, next_y = next_x + 1;
    h(x, next_y) -= pull / 2;
    h(next_y, x) -= pull / 2;
    h(y, next_x) += pull / 2;
    h(next_x, y) += pull / 2;
  }
  return h;
}

}  // namespace atlas
