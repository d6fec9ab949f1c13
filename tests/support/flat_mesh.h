// Flat meshes of slivers that rounding to floats closes or turns over.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas::test {

struct FlatMesh {
  std::string name;
  std::vector<Vec2d> uvs;
  std::vector<std::uint32_t> corners;
};

// Rows of points along a line with the given slope, each `height` above the last, all connected.
// The first and the last row of slivers adjoin proper triangles.
inline FlatMesh stack_of_slivers(int rows, int columns, double slope, double height) {
  FlatMesh mesh;
  mesh.name = std::to_string(rows) + " rows " + std::to_string(height) + " apart, slope " +
              std::to_string(slope);
  const double c = std::cos(slope), s = std::sin(slope);
  for (int r = 0; r <= rows; ++r) {
    const double across = r == 0 ? -0.2 : r == rows ? 0.2 : r * height;
    for (int i = 0; i <= columns; ++i) {
      const double along = -0.2 + 0.4 * (i + 0.37 * (r % 2)) / columns;
      mesh.uvs.push_back({0.5 + c * along - s * across, 0.5 + s * along + c * across});
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int i = 0; i < columns; ++i) {
      const auto a = std::uint32_t(r * (columns + 1) + i), b = a + 1, d = a + columns + 1,
                 e = d + 1;
      if (r % 2 == 0) {
        mesh.corners.insert(mesh.corners.end(), {a, b, d, b, e, d});
      } else {
        mesh.corners.insert(mesh.corners.end(), {a, b, e, a, e, d});
      }
    }
  }
  return mesh;
}

// Points along a line and beside it, in units of a float's last place. The three triangles at `mid`
// can only be opened by moving it along the line, by more than a hundred times the height that they
// lack.
inline FlatMesh leaning_slivers() {
  FlatMesh mesh;
  enum : std::uint32_t { start, mid, next, last, hub, near, far };
  for (const Vec2d p : {Vec2d{0, 0},
                        {165, 0.227},
                        {255, 0.351},
                        {338, 0.464},
                        {1.942e6, 0},
                        {4.254e5, 1585.6},
                        {6.331e5, 2206.9}}) {
    mesh.uvs.push_back({0.4 + p.x * 0x1p-24, 0.5 + p.y * 0x1p-24});
  }
  mesh.corners = {next, mid, hub,  mid, next, far,  start, hub,  mid,  start, mid,
                  near, far, near, mid, last, next, hub,   next, last, far};
  return mesh;
}

}  // namespace atlas::test
