// Turns a mesh of flat arrays (here a torus) into a vertex buffer with uvs for one texture.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "libatlas/unwrap/unwrap.h"

struct Vertex {
  float position[3], uv[2];
};

int main() {
  constexpr unsigned kAround = 48, kAcross = 24;
  constexpr double kTurn = 6.283185307179586;
  std::vector<atlas::Vec3f> positions;
  std::vector<std::uint32_t> indices;
  for (unsigned i = 0; i < kAround; ++i)
    for (unsigned j = 0; j < kAcross; ++j) {
      const double a = kTurn * i / kAround, b = kTurn * j / kAcross, r = 1 + 0.4 * std::cos(b);
      positions.push_back(
          {float(r * std::cos(a)), float(r * std::sin(a)), float(0.4 * std::sin(b))});
      const unsigned i1 = (i + 1) % kAround, j1 = (j + 1) % kAcross;
      const unsigned p = i * kAcross + j, q = i1 * kAcross + j, r1 = i1 * kAcross + j1,
                     s = i * kAcross + j1;
      for (unsigned v : {p, q, r1, p, r1, s}) indices.push_back(v);
    }

  atlas::MeshView mesh;
  mesh.positions = positions;
  mesh.indices = indices;
  atlas::UnwrapOptions options;
  options.page_size = 1024;
  const auto unwrapped = atlas::unwrap_mesh(mesh, options, {});
  if (!unwrapped.ok()) {
    std::fprintf(stderr, "%s\n", unwrapped.status().message().c_str());
    return 1;
  }

  // Draw these vertices with unwrapped->indices. Other attributes, such as normals, are copied in
  // the same way as the position.
  std::vector<Vertex> vertices;
  for (std::size_t v = 0; v < unwrapped->vertices.size(); ++v) {
    const atlas::Vec3f p = positions[unwrapped->vertices[v]];
    const atlas::Vec2f uv = unwrapped->uvs[v];
    vertices.push_back({{p.x, p.y, p.z}, {uv.x, uv.y}});
  }
  std::printf(
      "%zu triangles, %zu charts, stretch %.4f, %zu vertices of %zu, page %d x %d, %.0f %% used\n",
      unwrapped->indices.size() / 3, unwrapped->charts.charts.size(),
      unwrapped->charts.distortion.stretch_l2, vertices.size(), positions.size(),
      unwrapped->pages[0].width, unwrapped->pages[0].height, 100 * unwrapped->utilization);
}
