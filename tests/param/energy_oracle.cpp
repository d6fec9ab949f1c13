#include <Eigen/Dense>
#include <Eigen/SVD>
#include <cmath>

#include "tests/param/oracles.h"

namespace atlas::testing {

double isometric_energy(const LocalMesh& mesh, std::span<const Vec2d> uvs, double shear_weight) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto position = [&](int k) {
      const Vec3d p = mesh.positions[t[k]];
      return Eigen::Vector3d(p.x, p.y, p.z);
    };
    const auto uv = [&](int k) { return Eigen::Vector2d(uvs[t[k]].x, uvs[t[k]].y); };
    const Eigen::Vector3d e = position(1) - position(0), f = position(2) - position(0);
    const Eigen::Vector3d x = e.normalized(), y = (f - f.dot(x) * x).normalized();
    Eigen::Matrix2d rest, image;
    rest << e.dot(x), f.dot(x), e.dot(y), f.dot(y);
    image << uv(1) - uv(0), uv(2) - uv(0);
    const Eigen::Matrix2d j = image * rest.inverse();
    const Eigen::Vector2d s = Eigen::JacobiSVD<Eigen::Matrix2d>(j).singularValues();
    const double small = j.determinant() < 0 ? -s[1] : s[1];
    const double p = s[0] + small - 2, q = s[0] - small;
    // The integral over q of the spared shear, (1 - weight) q / (1 + 10 (q / 2)²).
    const double spared = (1 - shear_weight) / 5 * std::log(1 + 2.5 * q * q);
    sum += 0.5 * e.cross(f).norm() * (0.5 * (p * p + q * q) - spared);
  }
  return sum;
}

double arap_energy(const LocalMesh& mesh, std::span<const Vec2d> uvs) {
  return isometric_energy(mesh, uvs, 1);
}

}  // namespace atlas::testing
