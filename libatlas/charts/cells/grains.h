// Internal: what cells are grown from.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/mesh/topology.h"
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
  std::size_t count() const { return area.size(); }
};

inline glm::vec3 centroid(const Topology& topology, std::uint32_t t) {
  const std::uint32_t* v = &topology.corner_vertex[3 * std::size_t{t}];
  return (to_glm(topology.points[v[0]]) + to_glm(topology.points[v[1]]) +
          to_glm(topology.points[v[2]])) *
         (1.0f / 3.0f);
}

// Breadth-first patches, about twelve a cell, of triangles that lean less than 45 degrees to their
// first.
Grains grow_grains(const CellInput& input);

}  // namespace atlas
