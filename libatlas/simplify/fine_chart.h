// Internal: one chart of the fine mesh as a manifold with border, with local vertices and
// neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/half_edge.h"

namespace atlas::simplify {

// Where vertices lie. All charts share this.
struct Geometry {
  const MeshView* mesh = nullptr;
  const ChartSet* charts = nullptr;

  const Vec2d& uv(std::uint32_t id) const { return charts->uvs[id]; }
  std::uint32_t position_of(std::uint32_t uv_id) const { return charts->uv_vertex[uv_id]; }
  const Vec3f& position(std::uint32_t uv_id) const {
    return mesh->positions[charts->uv_vertex[uv_id]];
  }
};

// One chart as a manifold. Two triangles are neighbours if exactly these two share an edge between
// the same two uvs, in opposite directions. Every other edge is a border edge. A local vertex is
// one fan of triangles around one uv, so that each vertex has one disk or one half-disk of
// triangles. In uv, the triangle of a half-edge (core/half_edge.h) is on its left.
struct FineChart {
  std::vector<std::uint32_t> corners;   // 3 a triangle: local vertices
  std::vector<std::uint32_t> opposite;  // 3 a triangle: the half-edge on the other side or kNoIndex
  std::vector<std::uint32_t> vertex_half;  // 1 a vertex: a half-edge that leaves it; for a border
                                           // vertex, the one that runs along the border
  std::vector<std::uint32_t> vertex_uv;    // 1 a vertex: into ChartSet::uvs
  std::vector<std::uint32_t> source;       // 1 a triangle: triangle of the input
  std::uint64_t dropped = 0;               // triangles with two equal corners

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(vertex_uv.size()); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(source.size()); }
  bool border(std::uint32_t v) const { return opposite[vertex_half[v]] == kNoIndex; }
  std::uint32_t from(std::uint32_t h) const { return corners[h]; }
  std::uint32_t to(std::uint32_t h) const { return corners[next_half_edge(h)]; }
  // The half-edge along the border that ends at the border vertex v.
  std::uint32_t border_into(std::uint32_t v) const;
};

// Where the vertices of a fine chart lie, in the order of the vertices. Neighbours are close to
// each other in these arrays.
struct VertexPoints {
  std::vector<Vec2d> uvs;
  std::vector<Vec3f> positions;

  VertexPoints(const Geometry& geometry, const FineChart& fine);
};

// Builds one chart. `flipped` marks the triangles of the input whose orientation the chart
// reverses.
FineChart build_fine_chart(const Geometry& geometry, std::uint32_t chart,
                           const std::vector<bool>& flipped);

// Cuts charts open along edges to which the border of another sheet is attached. An example are
// three walls that share an edge, two of which lie in one chart. After the cut, all sheets at the
// edge are simplified together and none comes off. Returns the number of edges cut.
std::uint64_t cut_shared_edges(const Geometry& geometry, std::vector<FineChart>& charts,
                               const Context& context);

}  // namespace atlas::simplify
