// Meshes with uvs of their own, and the charts that are made from them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "tests/charts/chart_checks.h"

namespace atlas::test {

// Makes charts that keep the given ones, and expects the result to be sound.
inline ChartSet keep(const Mesh& mesh, ChartOptions options = {}, int threads = 1) {
  options.keep_uv_charts = true;
  Context context;
  context.threads = threads;
  Result<ChartSet> set = make_charts(mesh.view(), options, context);
  EXPECT_TRUE(set.ok()) << set.status().message();
  if (!set.ok()) return {};
  const ChartFindings found = check_charts(mesh.view(), *set);
  EXPECT_EQ(found.fault, "");
  EXPECT_NEAR(found.stretch_l2, set->distortion.stretch_l2, 1e-4 * found.stretch_l2);
  EXPECT_NEAR(found.stretch_999, set->distortion.stretch_999, 1e-3 * found.stretch_999);
  EXPECT_NEAR(found.seam, set->seam_length, 1e-5 * (1 + set->seam_length));
  return std::move(*set);
}

// Gives `mesh` the uvs of `set`. Each chart gets its own position and rotation; every third one is
// mirrored.
inline void wear(const ChartSet& set, double scale, Mesh& mesh) {
  mesh.texcoords.clear();
  for (std::size_t k = 0; k < set.charts.size(); ++k) {
    const Chart& chart = set.charts[k];
    const double c = scale * std::cos(1.7 * double(k)), s = scale * std::sin(1.7 * double(k));
    const double mirror = k % 3 == 2 ? -1 : 1;
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
      const Vec2d p = set.uvs[i];
      mesh.texcoords.push_back({float(mirror * (c * p.x - s * p.y) + 0.1 * double(k % 7)),
                                float(s * p.x + c * p.y + 0.1 * double(k % 5))});
    }
  }
  mesh.texcoord_indices = set.triangle_uv;
}

inline ChartSet cut(const Mesh& mesh) {
  Result<ChartSet> set = make_charts(mesh.view(), {}, {});
  EXPECT_TRUE(set.ok());
  return set.ok() ? std::move(*set) : ChartSet{};
}

// Returns a plate of n x n quads over the unit square with two charts side by side. `place` returns
// the uv of a point, given the half (0 or 1) that the corner belongs to.
inline Mesh halves(int n, const std::function<Vec2f(Vec3f, int)>& place) {
  Mesh mesh(grid(n, n));
  for (const int half : {0, 1}) {
    for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back(place(p, half));
  }
  const auto apart = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const bool right = int(i / 6) % n >= n / 2;
    mesh.texcoord_indices.push_back(mesh.indices[i] + (right ? apart : 0));
  }
  return mesh;
}

inline Vec2f apart(Vec3f p, int half) {
  return {p.x + 2 * float(half), p.y};
}

// Returns a mesh whose texcoords have the same indices as its positions.
inline Mesh mapped(const Shape& shape, const std::function<Vec2f(Vec3f)>& place) {
  Mesh mesh(shape);
  for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back(place(p));
  mesh.texcoord_indices = mesh.indices;
  return mesh;
}

}  // namespace atlas::test
