// Internal: what cells are grown from.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells.h"
#include "libatlas/charts/topology.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {

// Small patches of triangles: the graph on which seeds are chosen.
struct Grains {
  std::vector<std::uint32_t> of_triangle;
  std::vector<glm::vec3> centroid, normal;
  std::vector<float> area;
  std::vector<std::uint32_t> size;              // triangles
  std::vector<std::uint32_t> component;         // ascending: grains of a piece are contiguous
  std::vector<std::uint32_t> first, neighbour;  // compressed rows
  std::vector<float> distance;                  // 1 a neighbour: between the centroids
  std::vector<std::uint32_t> cells;             // 1 a piece: how many it gets
  std::vector<std::uint8_t> pierced;            // 1 a piece: it has handles, or holes
  std::size_t count() const { return area.size(); }
};

inline glm::vec3 centroid(const Topology& topology, std::uint32_t t) {
  const std::uint32_t* v = &topology.corner_vertex[3 * std::size_t{t}];
  return (to_glm(topology.points[v[0]]) + to_glm(topology.points[v[1]]) +
          to_glm(topology.points[v[2]])) *
         (1.0f / 3.0f);
}

// The triangles of each piece in order of id.
struct PieceList {
  std::vector<std::uint32_t> first, triangles;

  explicit PieceList(const Topology& topology) : first(topology.component_count + 2, 0) {
    const auto n = static_cast<std::uint32_t>(topology.triangle_count());
    for (std::uint32_t t = 0; t < n; ++t) {
      if (topology.component[t] != kNoIndex) ++first[topology.component[t] + 2];
    }
    for (std::size_t i = 2; i < first.size(); ++i) first[i] += first[i - 1];
    triangles.resize(first.back());
    for (std::uint32_t t = 0; t < n; ++t) {
      if (topology.component[t] != kNoIndex) triangles[first[topology.component[t] + 1]++] = t;
    }
    first.pop_back();
  }
};

// Breadth-first patches, about twelve a cell, of triangles that lean less than 45 degrees to their
// first.
Grains grow_grains(const Topology& topology, const CellOptions& options);

}  // namespace atlas
