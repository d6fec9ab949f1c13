// Meshes with charts that are made by hand, so that these tests do not depend on how charts are
// grown.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "libatlas/charts/charts.h"

namespace atlas::simplify_test {

struct ChartedMesh {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;
  ChartSet charts;

  MeshView view() const {
    MeshView mesh;
    mesh.positions = positions;
    mesh.indices = indices;
    return mesh;
  }
  std::size_t triangles() const { return indices.size() / 3; }
};

// Adds charts one by one. Positions that are bitwise equal become one vertex.
class ChartedMeshBuilder {
 public:
  struct Vertex {
    Vec3f position;
    Vec2d uv;
  };
  // Triangles are indices into `vertices`. Each vertex becomes one uv.
  void add_chart(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& triangles);

  // Adds a grid of nu x nv quads over [0, 1]². `at` returns position and uv of a parameter pair;
  // quads for which `keep` is false are left out. Diagonals alternate pseudo-randomly.
  using Map = std::function<Vertex(double s, double t)>;
  using Keep = std::function<bool(int i, int j)>;
  void add_grid(int nu, int nv, const Map& at, const Keep& keep = {});

  // Lists triangle t of the input as flipped, with its corners in reverse order.
  void flip(std::uint32_t t);
  ChartedMesh build() const { return mesh_; }

 private:
  std::uint32_t vertex(const Vec3f& position);
  ChartedMesh mesh_;
  std::map<std::array<float, 3>, std::uint32_t> known_;
};

ChartedMesh box(int n, double size = 1, Vec3d corner = {0, 0, 0});
ChartedMesh sphere(int n);                   // six projected charts
ChartedMesh plate_with_hole(int n);          // one flat chart with a square hole
ChartedMesh cylinder(int n, bool cut);       // one chart that meets itself, or two charts
ChartedMesh bumpy(int n, double amplitude);  // a height field with noise
ChartedMesh partition(int n);                // three walls that share one edge: non-manifold
// A wall on a height field, which is one chart: the edges at the foot of the wall have three
// triangles.
ChartedMesh wall_on_field(int n, double amplitude);
ChartedMesh torus(int n);                   // one chart that meets itself at two cuts
ChartedMesh moebius(int n);                 // one chart that meets itself with a twist
ChartedMesh two_sided(int n);               // a plate and its back, over the same vertices
ChartedMesh touching_plates(int n, int m);  // two grids with different steps along one line
// A height field cut into charts of random outline. Of 8 random labels, `holes` become holes.
// Charts may have several parts and touch themselves at single points.
ChartedMesh patchwork(int n, int holes, double amplitude, std::uint32_t seed);

}  // namespace atlas::simplify_test
