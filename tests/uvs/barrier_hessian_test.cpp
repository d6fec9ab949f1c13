// The closed form of a barrier's positive Hessian agrees with an eigenvalue decomposition.
#include "libatlas/uvs/barrier_hessian.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

namespace atlas::test {
namespace {

using Vector = Eigen::Matrix<double, 6, 1>;
using Matrix = Eigen::Matrix<double, 6, 6>;

Matrix hessian_of_area() {
  Matrix k = Matrix::Zero();
  for (int a = 0; a < 3; ++a) {  // the cross product of corners a and a + 1
    const int p = 2 * a, q = 2 * ((a + 1) % 3);
    k(p, q + 1) = k(q + 1, p) = 1;
    k(p + 1, q) = k(q, p + 1) = -1;
  }
  return k;
}

Matrix by_eigenvalues(const Matrix& h) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(h);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

void expect_agreement(const Vector& corners, double bend, double pull) {
  const Matrix k = hessian_of_area();
  const Vector g = k * corners;
  EXPECT_LE((area_hessian_times(corners) - g).norm(), 1e-14 * g.norm());
  const Matrix h = bend * g * g.transpose() - pull * k;
  const double off = (positive_barrier_hessian(g, bend, pull) - by_eigenvalues(h)).norm();
  EXPECT_LE(off, 1e-13 * h.norm()) << corners.transpose() << " bend " << bend << " pull " << pull;
}

TEST(BarrierHessian, AgreesWithEigenvalues) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-6, 6);
  int tried = 0;
  while (tried < 20000) {
    Vector x;
    const double flat = std::pow(10, std::min(0.0, exponent(random)));  // slivers, half of them
    for (int k = 0; k < 3; ++k) x[2 * k] = normal(random), x[2 * k + 1] = flat * normal(random);
    const double twice = x.dot(hessian_of_area() * x) / 2;
    if (twice <= 0) continue;
    // Both signs of the smaller eigenvalue in the plane, far from and close to 0.
    const double bend = std::pow(10, exponent(random));
    const double edge = bend * 2 * twice;  // the pull at which that eigenvalue is 0
    expect_agreement(x, bend, edge * std::pow(10, exponent(random)));
    expect_agreement(x, bend, edge * (1 + 1e-9 * normal(random)));
    ++tried;
  }
}

TEST(BarrierHessian, AgreesForEquilateralTrianglesAndWithoutBendOrPull) {
  const double high = std::sqrt(3.0) / 2;
  for (const double shift : {0.0, 1e-12, 1e-8, 1e-4}) {
    const Vector x{0, 0, 1, 0, 0.5 + shift, high};
    for (const double pull : {0.0, 1e-3, 1.0, 2 * high, 1e3}) {
      expect_agreement(x, 1, pull);
      expect_agreement(x, 0, pull);
    }
  }
}

}  // namespace
}  // namespace atlas::test
