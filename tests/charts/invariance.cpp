#include "tests/charts/invariance.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "libatlas/core/glm_bridge.h"

namespace atlas::test {

WideMesh widened(const Shape& shape) {
  WideMesh mesh{shape.name, {}, shape.indices};
  for (const Vec3f& p : shape.positions) mesh.positions.push_back({p.x, p.y, p.z});
  return mesh;
}

// Uses Rodrigues' formula.
Turn turn_about(Vec3d axis, double angle) {
  const glm::dvec3 a = glm::normalize(to_glm(axis));
  const double c = std::cos(angle), s = std::sin(angle), d = 1 - c;
  return {c + d * a.x * a.x,       d * a.x * a.y - s * a.z, d * a.x * a.z + s * a.y,
          d * a.x * a.y + s * a.z, c + d * a.y * a.y,       d * a.y * a.z - s * a.x,
          d * a.x * a.z - s * a.y, d * a.y * a.z + s * a.x, c + d * a.z * a.z};
}

Turn random_turn(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
  const double z = 2 * uniform() - 1, angle = 2 * std::numbers::pi * uniform();
  const double r = std::sqrt(1 - z * z);
  return turn_about({r * std::cos(angle), r * std::sin(angle), z},
                    2 * std::numbers::pi * uniform());
}

WideMesh turned(WideMesh mesh, const Turn& m) {
  for (Vec3d& p : mesh.positions) {
    p = {m[0] * p.x + m[1] * p.y + m[2] * p.z, m[3] * p.x + m[4] * p.y + m[5] * p.z,
         m[6] * p.x + m[7] * p.y + m[8] * p.z};
  }
  return mesh;
}

WideMesh scaled(WideMesh mesh, double factor) {
  for (Vec3d& p : mesh.positions) p = {factor * p.x, factor * p.y, factor * p.z};
  return mesh;
}

WideMesh shifted(WideMesh mesh, Vec3d offset) {
  for (Vec3d& p : mesh.positions) p = {p.x + offset.x, p.y + offset.y, p.z + offset.z};
  return mesh;
}

Shape narrowed(const WideMesh& mesh) {
  Shape shape{mesh.name, {}, mesh.indices};
  for (const Vec3d& p : mesh.positions) {
    shape.positions.push_back({float(p.x), float(p.y), float(p.z)});
  }
  return shape;
}

ChartSet charts_of(const Shape& shape, int threads) {
  Context context;
  context.threads = threads;
  MeshView view;
  view.positions = shape.positions;
  view.indices = shape.indices;
  Result<ChartSet> made = make_charts(view, {}, context);
  EXPECT_TRUE(made.ok()) << shape.name << ": " << made.status().message();
  return made.ok() ? std::move(*made) : ChartSet{};
}

void Comparison::add(const std::string& name, const ChartSet& charts, const ChartSet& reference,
                     double factor) {
  const auto n = double(charts.charts.size()), n0 = double(reference.charts.size());
  const double l2 = reference.distortion.stretch_l2;
  EXPECT_LE(std::abs(n - n0), 0.03 * n0 + 2) << name;
  EXPECT_NEAR(charts.distortion.stretch_l2, l2, 0.01 * l2) << name;
  EXPECT_EQ(charts.distortion.flips, 0u) << name;
  const double seam = charts.seam_length / factor, seam0 = reference.seam_length;
  const double size = std::sqrt(reference.surface_area);
  const bool alike =
      std::abs(n - n0) <= 0.03 * n0 && std::abs(seam - seam0) <= 0.03 * seam0 + 1e-6 * size;
  ++cases_;
  alike_ += alike;
  if (!alike)
    others_ += fmt::format("\n{}: {} charts, seams {:.3f} instead of {}, {:.3f}", name, n,
                           seam / size, n0, seam0 / size);
}

Comparison::~Comparison() {
  EXPECT_GT(cases_, 0);
  EXPECT_GE(alike_, 0.9 * cases_) << others_;
}

}  // namespace atlas::test
