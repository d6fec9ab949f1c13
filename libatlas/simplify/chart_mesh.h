// Internal: the half-edge mesh of one chart. OpenMesh stays behind this header, in one .cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "libatlas/simplify/fine_chart.h"

namespace atlas::simplify {

// The neighbours of a vertex, counter-clockwise in uv. Face i lies between neighbours i and i + 1;
// a border vertex has one face fewer than neighbours.
struct Ring {
  std::vector<std::uint32_t> vertices, faces;
  bool border = false;
};

// Face and vertex ids are those of the fine chart, for as long as they live.
class ChartMesh {
 public:
  explicit ChartMesh(const FineChart& fine);
  ~ChartMesh();
  ChartMesh(ChartMesh&&) noexcept;

  void ring(std::uint32_t v, Ring& out) const;
  // Number of neighbours, counted no further than `limit`.
  std::size_t valence(std::uint32_t v, std::size_t limit) const;
  // Whether v may be merged into its neighbour w without making the mesh non-manifold.
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
