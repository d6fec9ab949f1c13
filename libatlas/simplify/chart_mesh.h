// Internal: the half-edge mesh of one chart. OpenMesh is included only in chart_mesh.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "libatlas/simplify/fine_chart.h"

namespace atlas::simplify {

// The neighbours of a vertex, counter-clockwise in uv. Face i lies between the neighbours i and i
// + 1. A border vertex has one face fewer than it has neighbours.
struct Ring {
  std::vector<std::uint32_t> vertices, faces;
  bool border = false;
};

// The half-edge mesh. Faces and vertices keep the ids of the fine chart until they are removed.
class ChartMesh {
 public:
  explicit ChartMesh(const FineChart& fine);
  ~ChartMesh();
  ChartMesh(ChartMesh&&) noexcept;

  void ring(std::uint32_t v, Ring& out) const;
  // The number of neighbours. Counting stops at `limit`.
  std::size_t valence(std::uint32_t v, std::size_t limit) const;
  // Whether v can be merged into its neighbour w without making the mesh non-manifold.
  bool can_collapse(std::uint32_t v, std::uint32_t w);
  void collapse(std::uint32_t v, std::uint32_t w);
  bool vertex_alive(std::uint32_t v) const;
  bool face_alive(std::uint32_t face) const;
  std::array<std::uint32_t, 3> corners(std::uint32_t face) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace atlas::simplify
