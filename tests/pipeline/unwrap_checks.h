// Checks what must hold for every unwrapped mesh.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

#include "libatlas/scene/scene.h"
#include "libatlas/unwrap/unwrap.h"

namespace atlas::test {

inline MeshView view_of(const Scene& scene) {
  MeshView view;
  view.positions = scene.positions;
  view.indices = scene.indices;
  return view;
}

inline double turn(const UnwrappedMesh& mesh, std::size_t triangle) {
  const Vec2f a = mesh.uvs[mesh.indices[3 * triangle]],
              b = mesh.uvs[mesh.indices[3 * triangle + 1]],
              c = mesh.uvs[mesh.indices[3 * triangle + 2]];
  return (double(b.x) - a.x) * (double(c.y) - a.y) - (double(b.y) - a.y) * (double(c.x) - a.x);
}

inline void expect_sound(const MeshView& input, const UnwrappedMesh& mesh) {
  ASSERT_EQ(mesh.indices.size(), input.indices.size());
  ASSERT_EQ(mesh.uvs.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.triangle_page.size(), input.indices.size() / 3);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    ASSERT_EQ(mesh.vertices[mesh.indices[i]], input.indices[i]) << "corner " << i;
  for (const Vec2f uv : mesh.uvs)
    EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1) << uv.x << ' ' << uv.y;
  std::set<std::size_t> flipped(mesh.charts.flipped_triangles.begin(),
                                mesh.charts.flipped_triangles.end());
  std::vector<double> area(mesh.pages.size());
  for (std::size_t t = 0; t < mesh.triangle_page.size(); ++t) {
    EXPECT_EQ(turn(mesh, t) > 0, !flipped.contains(t)) << "triangle " << t;
    area[mesh.triangle_page[t]] += std::abs(turn(mesh, t)) / 2;
  }
  double texels = 0, room = 0;
  for (std::size_t p = 0; p < area.size(); ++p) {
    texels += area[p] * double(mesh.pages[p].area());
    room += double(mesh.pages[p].area());
  }
  EXPECT_NEAR(texels / room, mesh.utilization, 1e-4);
  // All charts have one density: texels of a chart per area of its uvs.
  EXPECT_NEAR(std::sqrt(texels / mesh.charts.distortion.uv_area), mesh.texels_per_unit,
              1e-3 * mesh.texels_per_unit);
}

}  // namespace atlas::test
